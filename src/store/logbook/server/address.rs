//! The address of a server with a shared logbook, as a setting or an environment variable names it. The password is
//! kept apart from the address and is never displayed.

use std::fmt;
use std::path::PathBuf;

use tokio_postgres::Config;
use tokio_postgres::config::Host;

const DEFAULT_PORT: u16 = 5432;

/// Address of a PostgreSQL database: `postgres://USER@HOST:PORT/DATABASE`, without a password.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ServerAddress {
    /// Address as text, without a password.
    text: String,
    pub(super) config: Config,
    pub(super) encryption: Encryption,
    /// Password that an environment variable contains.
    pub(super) password: Option<Password>,
}

/// Encryption of the connection to a server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Encryption {
    Off,
    /// TLS with a verified certificate. The file contains the certificates of the authorities to trust; without a file,
    /// those of the system are trusted.
    Verified(Option<PathBuf>),
}

/// A password. Its value is neither displayed nor logged.
#[derive(Clone, PartialEq, Eq)]
pub struct Password(String);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ServerAddressError {
    /// The text does not begin with `postgres://`, or does not name a host.
    #[error("the address is not of the form postgres://USER@HOST/DATABASE")]
    NotAnAddress,
    /// The address contains a password where it would be stored in a file.
    #[error("the address contains a password")]
    ContainsPassword,
    #[error("sslmode={found} is not supported")]
    UnknownEncryption { found: String },
}

impl ServerAddress {
    /// Parses an address of the settings, which must not contain a password.
    ///
    /// # Errors
    /// Returns an error if the text is not an address or contains a password.
    pub fn from_setting(text: &str) -> Result<Self, ServerAddressError> {
        let address = Self::from_environment(text)?;
        match address.password {
            Some(_) => Err(ServerAddressError::ContainsPassword),
            None => Ok(address),
        }
    }

    /// Parses an address of an environment variable, which may contain a password.
    ///
    /// # Errors
    /// Returns an error if the text is not an address.
    pub fn from_environment(text: &str) -> Result<Self, ServerAddressError> {
        let text = text.trim();
        if !["postgres://", "postgresql://"].iter().any(|scheme| text.starts_with(scheme)) {
            return Err(ServerAddressError::NotAnAddress);
        }
        let (base, query) = text.split_once('?').unwrap_or((text, ""));
        let parameter = |name: &str| {
            let own = |pair: &&str| pair.split_once('=').is_some_and(|(key, _)| key == name);
            query.split('&').find(own).and_then(|pair| pair.split_once('=')).map(|(_, value)| value.to_owned())
        };
        let without = |names: &[&str]| {
            let is_kept =
                |pair: &&str| !pair.is_empty() && !names.contains(&pair.split('=').next().unwrap_or_default());
            let kept: Vec<&str> = query.split('&').filter(is_kept).collect();
            if kept.is_empty() { String::new() } else { format!("?{}", kept.join("&")) }
        };
        // The client knows only some modes and no file of certificates.
        let parsed = format!("{base}{}", without(&["sslmode", "sslrootcert"])).parse();
        let config: Config = parsed.map_err(|_| ServerAddressError::NotAnAddress)?;
        if config.get_hosts().is_empty() {
            return Err(ServerAddressError::NotAnAddress);
        }
        let authorities = parameter("sslrootcert").map(PathBuf::from);
        let encryption = match parameter("sslmode").as_deref() {
            Some("disable") => Encryption::Off,
            Some("require" | "verify-ca" | "verify-full") => Encryption::Verified(authorities),
            Some(found) => return Err(ServerAddressError::UnknownEncryption { found: found.to_owned() }),
            None if authorities.is_none() && config.get_hosts().iter().all(is_local_host) => Encryption::Off,
            None => Encryption::Verified(authorities),
        };
        let password = config.get_password().map(|bytes| Password(String::from_utf8_lossy(bytes).into_owned()));
        let text = format!("{}{}", without_password(base), without(&["password"]));
        Ok(ServerAddress { text, config, encryption, password })
    }

    /// Returns the account on the server, under which the keyring has its password.
    pub(super) fn account(&self) -> String {
        let user = self.config.get_user().map(|user| format!("{user}@")).unwrap_or_default();
        format!("{user}{}", self.name())
    }

    /// Returns this address with a password, or with its own one if `password` is `None`.
    #[must_use]
    pub fn with_password(self, password: Option<Password>) -> Self {
        ServerAddress { password: password.or(self.password), ..self }
    }

    pub fn has_password(&self) -> bool {
        self.password.is_some()
    }

    /// Returns host, port and database, for messages.
    pub fn name(&self) -> String {
        let host = match self.config.get_hosts().first() {
            Some(Host::Tcp(name)) => name.clone(),
            #[cfg(unix)]
            Some(Host::Unix(path)) => path.display().to_string(),
            None => String::new(),
        };
        let port = self.config.get_ports().first().copied().unwrap_or(DEFAULT_PORT);
        let port = if port == DEFAULT_PORT { String::new() } else { format!(":{port}") };
        let database = self.config.get_dbname().map(|name| format!("/{name}")).unwrap_or_default();
        format!("{host}{port}{database}")
    }
}

impl fmt::Display for ServerAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Password {
    /// Returns the password in the environment variable that all clients of PostgreSQL use.
    pub(super) fn from_environment() -> Option<Self> {
        Password::new(std::env::var("PGPASSWORD").ok()?)
    }

    /// Creates a password, or returns `None` if the text is empty.
    pub fn new(text: String) -> Option<Self> {
        Some(text).filter(|text| !text.is_empty()).map(Password)
    }

    pub(super) fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Password {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Password(…)")
    }
}

/// Returns whether a host is this computer. Such a connection cannot be read from outside.
fn is_local_host(host: &Host) -> bool {
    match host {
        Host::Tcp(name) => {
            name == "localhost" || name.parse().is_ok_and(|address: std::net::IpAddr| address.is_loopback())
        }
        #[cfg(unix)]
        Host::Unix(_) => true,
    }
}

/// Returns the part of an address before its parameters, without the password of the user.
fn without_password(base: &str) -> String {
    let Some((scheme, rest)) = base.split_once("://") else { return base.to_owned() };
    let (authority, path) = rest.find('/').map_or((rest, ""), |at| rest.split_at(at));
    let Some((user, host)) = authority.rsplit_once('@') else { return base.to_owned() };
    let user = user.split(':').next().unwrap_or_default();
    format!("{scheme}://{user}@{host}{path}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_kept_apart_and_is_refused_in_a_setting() {
        let cases = [
            ("postgres://bench:s3cret@db.plant:5433/logs", "postgres://bench@db.plant:5433/logs"),
            (
                "postgres://bench:s%40cret@db.plant/logs?sslmode=require",
                "postgres://bench@db.plant/logs?sslmode=require",
            ),
            ("postgres://bench@db.plant/logs?password=s3cret", "postgres://bench@db.plant/logs"),
        ];
        for (given, shown) in cases {
            assert_eq!(ServerAddress::from_setting(given), Err(ServerAddressError::ContainsPassword), "{given}");
            let address = ServerAddress::from_environment(given).unwrap();
            assert_eq!(address.to_string(), shown);
            assert!(address.password.as_ref().is_some_and(|password| password.reveal().ends_with("cret")));
            assert!(!format!("{address:?}{}", address.name()).contains("cret"), "{address:?}");
        }
        let plain = ServerAddress::from_setting(" postgresql://bench@db.plant/logs ").unwrap();
        assert_eq!((plain.name().as_str(), plain.password), ("db.plant/logs", None));
    }

    #[test]
    fn only_local_connections_are_unencrypted_by_default() {
        let encryption = |text: &str| ServerAddress::from_setting(text).map(|address| address.encryption);
        for near in
            ["postgres://localhost/x", "postgres://127.0.0.1:5433/x", "postgres://[::1]/x", "postgres://%2Frun/x"]
        {
            assert_eq!(encryption(near), Ok(Encryption::Off), "{near}");
        }
        assert_eq!(encryption("postgres://db.plant/x"), Ok(Encryption::Verified(None)));
        assert_eq!(encryption("postgres://db.plant/x?sslmode=disable"), Ok(Encryption::Off));
        let file = Encryption::Verified(Some(PathBuf::from("/etc/ca.pem")));
        assert_eq!(encryption("postgres://localhost/x?sslrootcert=/etc/ca.pem"), Ok(file));
        let unknown = ServerAddressError::UnknownEncryption { found: "prefer".to_owned() };
        assert_eq!(encryption("postgres://db.plant/x?sslmode=prefer"), Err(unknown));
    }

    #[test]
    fn invalid_addresses_are_refused() {
        for bad in ["", "db.plant", "host=db.plant password=x", "mysql://db.plant/x", "postgres://", "postgres:///x"] {
            assert_eq!(ServerAddress::from_setting(bad), Err(ServerAddressError::NotAnAddress), "{bad}");
        }
    }
}
