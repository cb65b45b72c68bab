//! What is the same in the connection forms of all devices: an entry that must not be empty, host and port, and a link
//! put together from its parts.

use std::net::Ipv6Addr;
use std::num::NonZeroU16;

use crate::app::Text;
use crate::link::{LinkUrl, Scheme, UrlError};

/// An entry without the blanks around it.
///
/// # Errors
/// `missing`, where it is empty.
pub(super) fn entered(entry: &str, missing: &'static str) -> Result<String, Text> {
    let entry = entry.trim();
    if entry.is_empty() { Err(Text::new(missing)) } else { Ok(entry.to_owned()) }
}

/// An entry, unless it is empty.
pub(super) fn filled(entry: &str) -> Option<String> {
    Some(entry.trim().to_owned()).filter(|entry| !entry.is_empty())
}

/// Host and port as a link takes them.
///
/// # Errors
/// A sentence that says which of them cannot be used.
pub(super) fn host_and_port(host: &str, port: &str) -> Result<String, Text> {
    let host = entered(host, "form.host_missing")?;
    let host = match host.parse::<Ipv6Addr>() {
        Ok(_) => format!("[{host}]"),
        Err(_) if host.contains(':') && !host.starts_with('[') => {
            return Err(Text::new("form.host").with("value", host));
        }
        Err(_) => host,
    };
    let port = entered(port, "form.tcp_port_missing")?;
    match port.parse::<NonZeroU16>() {
        Ok(port) => Ok(format!("{host}:{port}")),
        Err(_) => Err(Text::new("form.tcp_port").with("value", port)),
    }
}

/// Puts a link together. The inner error is for whoever knows which entry a parameter comes from.
///
/// # Errors
/// A sentence where a character would end a part of the link.
pub(super) fn assemble(
    scheme: Scheme,
    target: &str,
    parameters: &[(String, String)],
) -> Result<Result<LinkUrl, UrlError>, Text> {
    let unfit = |text: &str, characters: &[char]| text.contains(characters).then(|| text.to_owned());
    let unfit = unfit(target, &['?'])
        .or_else(|| parameters.iter().find_map(|(name, value)| unfit(name, &['&']).or_else(|| unfit(value, &['&']))));
    if let Some(value) = unfit {
        return Err(Text::new("form.characters").with("value", value));
    }
    let words: Vec<String> = parameters.iter().map(|(name, value)| format!("{name}={value}")).collect();
    let question = if words.is_empty() { "" } else { "?" };
    Ok(format!("{}:{target}{question}{}", scheme.word(), words.join("&")).parse())
}
