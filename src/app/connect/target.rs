//! Helpers for all connection forms: mandatory entries, host and port, and the reasons why a link cannot be used.

use std::net::Ipv6Addr;
use std::num::NonZeroU16;

use crate::app::{Text, explain};
use crate::link::{LinkUrl, UrlError};
use crate::sim::ConfigError;
use crate::worker::OpenError;

/// Returns an entry without surrounding whitespace.
///
/// # Errors
/// Returns the message `missing` if the entry is empty.
pub(crate) fn required_entry(entry: &str, missing: &'static str) -> Result<String, Text> {
    let entry = entry.trim();
    if entry.is_empty() { Err(Text::new(missing)) } else { Ok(entry.to_owned()) }
}

pub(crate) fn optional_entry(entry: &str) -> Option<String> {
    Some(entry.trim().to_owned()).filter(|entry| !entry.is_empty())
}

const MISSING_ENTRY_IDS: [&str; 6] = [
    "form.port_missing",
    "form.host_missing",
    "form.gateway_missing",
    "form.device_missing",
    "form.tcp_port_missing",
    "form.file_missing",
];

pub fn is_missing(problem: &Text) -> bool {
    MISSING_ENTRY_IDS.contains(&problem.id())
}

/// Returns the link if its kind of device accepts it.
///
/// # Errors
/// Returns the reason given by [`rejection_text`].
pub(crate) fn validated_link(
    url: LinkUrl,
    check: impl FnOnce(&LinkUrl) -> Result<(), OpenError>,
) -> Result<LinkUrl, Text> {
    check(&url).map_err(|error| rejection_text(&url, &error))?;
    Ok(url)
}

/// Returns the reason why a link cannot be used. The message names the invalid entry, if there is one.
pub(crate) fn rejection_text(url: &LinkUrl, error: &OpenError) -> Text {
    let (name, value, allowed) = match error {
        OpenError::Url(UrlError::Value { name, value, allowed })
        | OpenError::Sim(ConfigError::Value { key: name, value, allowed }) => (name, value, allowed),
        OpenError::Sim(ConfigError::Fault(_)) => {
            return Text::new("form.fault").with("value", url.query.get("fault").unwrap_or_default());
        }
        OpenError::Url(error) => return unusable_link_text(explain::url_error_text(error)),
        OpenError::Sim(error) => return unusable_link_text(explain::setting_error_text(error)),
        error => return explain::open_error_text(error),
    };
    let own = [("margin", "form.margin"), ("rpm", "form.rpm"), ("clock", "form.clock")];
    match own.iter().find(|(own, _)| own == name) {
        Some((_, id)) => Text::new(id).with("value", value).with_text("allowed", explain::expected_text(allowed)),
        None => Text::new("form.parameter")
            .with("name", name)
            .with("value", value)
            .with_text("why", explain::expected_text(allowed)),
    }
}

/// Returns the message for a link that cannot be used although every entry is valid.
pub(crate) fn unusable_link_text(why: Text) -> Text {
    Text::new("form.other").with_text("why", why)
}

/// Formats host and port as in a link.
///
/// # Errors
/// Returns a text that names the invalid part.
pub(crate) fn host_and_port(host: &str, port: &str) -> Result<String, Text> {
    let host = required_entry(host, "form.host_missing")?;
    let host = match host.parse::<Ipv6Addr>() {
        Ok(_) => format!("[{host}]"),
        Err(_) if host.contains(':') && !host.starts_with('[') => {
            return Err(Text::new("form.host").with("value", host));
        }
        Err(_) => host,
    };
    let port = required_entry(port, "form.tcp_port_missing")?;
    match port.parse::<NonZeroU16>() {
        Ok(port) => Ok(format!("{host}:{port}")),
        Err(_) => Err(Text::new("form.tcp_port").with("value", port)),
    }
}

/// Formats host and port as in a link. An empty port means the default.
///
/// # Errors
/// Returns the same errors as [`host_and_port`], or `missing` if no host is entered.
pub(crate) fn format_host_and_optional_port(
    host: &str,
    missing: &'static str,
    port: &str,
    usual: &str,
) -> Result<String, Text> {
    host_and_port(&required_entry(host, missing)?, optional_entry(port).as_deref().unwrap_or(usual))
}

/// Splits a network address into host and port. The port is empty if the address has none.
pub(crate) fn split_target(place: &str) -> (String, String) {
    let (host, port) = place.rsplit_once(':').unwrap_or((place, ""));
    (host.to_owned(), port.to_owned())
}

/// Splits a network address into host and port. The port is empty if it is the default port.
pub(crate) fn split_host_default_port(place: &str, usual: &str) -> (String, String) {
    let (host, port) = split_target(place);
    (host, Some(port).filter(|port| port != usual).unwrap_or_default())
}

/// Prefix in the link of an adapter on the network.
const TCP: &str = "tcp:";

/// Returns the network address of an adapter, or `None` if it is on a serial port.
pub(crate) fn adapter_network_address(target: &str) -> Option<&str> {
    target.strip_prefix(TCP)
}

/// Returns the target part of the link to an adapter on the network.
///
/// # Errors
/// Returns the same errors as [`host_and_port`].
pub(crate) fn for_adapter(host: &str, port: &str) -> Result<String, Text> {
    Ok(format!("{TCP}{}", host_and_port(host, port)?))
}
