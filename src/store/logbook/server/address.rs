//! The address of a logbook server, as given in the settings or an environment variable. The password is stored
//! separately and is never displayed.

use std::fmt;
use std::path::PathBuf;

use tokio_postgres::Config;
use tokio_postgres::config::Host;

pub(super) const DEFAULT_PORT: u16 = 5432;

const PASSWORD: &str = "password";

/// TLS parameters of an address. They are handled here, because the client library supports only some modes and no
/// certificate file.
const TLS_PARAMETERS: [&str; 2] = ["sslmode", "sslrootcert"];

/// Permitted parameters of an address. Others could redirect the connection or hide a password.
const PARAMETERS: [&str; 9] = [
    "sslmode",
    "sslrootcert",
    "channel_binding",
    "host",
    "port",
    "user",
    "dbname",
    "target_session_attrs",
    "load_balance_hosts",
];

/// Address of a PostgreSQL database: `postgres://USER@HOST:PORT/DATABASE`, without a password.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ServerAddress {
    /// Text of the address, without a password.
    text: String,
    pub(super) config: Config,
    pub(super) encryption: Encryption,
    /// Password from the address in an environment variable.
    pub(super) password: Option<Password>,
}

/// Encryption of the connection to the server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Encryption {
    Off,
    /// TLS with certificate verification. The file contains the trusted certificate authorities; without a file, the
    /// system's are used.
    Verified(Option<PathBuf>),
}

/// A password. Its value is neither displayed nor logged.
#[derive(Clone, PartialEq, Eq)]
pub struct Password(String);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ServerAddressError {
    /// The text does not begin with `postgres://` or contains no host.
    #[error("the address is not of the form postgres://USER@HOST/DATABASE")]
    NotAnAddress,
    /// A name or password contains a character that separates the parts of an address.
    #[error("the address contains one of the characters @ / ? & within a name or a password")]
    Ambiguous,
    #[error("the parameter {name} is not supported")]
    UnknownParameter { name: String },
    /// An address in the settings contains a password, which would be stored in a file.
    #[error("the address contains a password")]
    ContainsPassword,
    #[error("sslmode={found} is not supported")]
    UnknownEncryption { found: String },
    /// The settings cannot be read. They may contain a server address.
    #[error("the settings cannot be read")]
    SettingsUnreadable,
}

impl ServerAddress {
    /// Parses an address from the settings, which must not contain a password.
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

    /// Parses an address from an environment variable, which may contain a password.
    ///
    /// # Errors
    /// Returns an error if the text is not an address.
    pub fn from_environment(text: &str) -> Result<Self, ServerAddressError> {
        let text = text.trim();
        let schemes = ["postgres://", "postgresql://"];
        let scheme = schemes.into_iter().find(|scheme| text.starts_with(scheme));
        let (Some(scheme), Some((_, rest))) = (scheme, text.split_once("://")) else {
            return Err(ServerAddressError::NotAnAddress);
        };
        // The client takes everything before the first @ as the user and the password, even a / or ?.
        let (account, rest) = rest.split_once('@').map_or((None, rest), |(account, rest)| (Some(account), rest));
        if rest.contains('@') || account.is_some_and(|account| account.contains(['/', '?'])) {
            return Err(ServerAddressError::Ambiguous);
        }
        let (place, query) = rest.split_once('?').unwrap_or((rest, ""));
        let pairs = query.split('&').filter(|pair| !pair.is_empty()).map(|pair| pair.split_once('='));
        // A part without a name may be the end of a password with &.
        let pairs: Vec<(&str, &str)> = pairs.collect::<Option<_>>().ok_or(ServerAddressError::Ambiguous)?;
        // What follows a password may belong to it, so no message contains it.
        let hides_password = pairs.iter().any(|(name, _)| *name == PASSWORD);
        let reject = |error| if hides_password { ServerAddressError::Ambiguous } else { error };
        if let Some((name, _)) = pairs.iter().find(|(name, _)| *name != PASSWORD && !PARAMETERS.contains(name)) {
            return Err(reject(ServerAddressError::UnknownParameter { name: (*name).to_owned() }));
        }
        let parameter = |name: &str| pairs.iter().find(|(own, _)| *own == name).map(|(_, value)| *value);
        let parsed =
            join(scheme, account, place, pairs.iter().filter(|(name, _)| !TLS_PARAMETERS.contains(name))).parse();
        let config: Config = parsed.map_err(|_| ServerAddressError::NotAnAddress)?;
        if config.get_hosts().is_empty() {
            return Err(ServerAddressError::NotAnAddress);
        }
        let authorities = parameter("sslrootcert").map(PathBuf::from);
        let encryption = match parameter("sslmode") {
            Some("disable") => Encryption::Off,
            Some("require" | "verify-ca" | "verify-full") => Encryption::Verified(authorities),
            Some(found) => return Err(reject(ServerAddressError::UnknownEncryption { found: found.to_owned() })),
            None if authorities.is_none() && config.get_hosts().iter().all(is_local_host) => Encryption::Off,
            None => Encryption::Verified(authorities),
        };
        let password = config.get_password().map(|bytes| Password(String::from_utf8_lossy(bytes).into_owned()));
        let user = account.map(|account| account.split_once(':').map_or(account, |(user, _)| user));
        let text = join(scheme, user, place, pairs.iter().filter(|(name, _)| *name != PASSWORD));
        Ok(ServerAddress { text, config, encryption, password })
    }

    /// Returns the account under which the keyring stores the password for the server.
    pub(super) fn account(&self) -> String {
        let user = self.config.get_user().map(|user| format!("{user}@")).unwrap_or_default();
        format!("{user}{}", self.name())
    }

    /// Returns this address with the given password. If `password` is `None`, the address keeps its own.
    #[must_use]
    pub fn with_password(self, password: Option<Password>) -> Self {
        ServerAddress { password: password.or(self.password), ..self }
    }

    pub(crate) fn password(&self) -> Option<&Password> {
        self.password.as_ref()
    }

    pub fn has_password(&self) -> bool {
        self.password.is_some()
    }

    /// Returns the host, port and database for use in messages.
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
    /// Returns the password from the environment variable that all PostgreSQL clients use.
    pub(super) fn from_environment() -> Option<Self> {
        Password::new(std::env::var("PGPASSWORD").ok()?)
    }

    /// Creates a password, or returns `None` if the text is empty.
    pub fn new(text: String) -> Option<Self> {
        Some(text).filter(|text| !text.is_empty()).map(Password)
    }

    pub(crate) fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Password {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Password(…)")
    }
}

/// Returns whether a host is this computer. Such a connection cannot be intercepted on the network.
fn is_local_host(host: &Host) -> bool {
    match host {
        Host::Tcp(name) => {
            name == "localhost" || name.parse().is_ok_and(|address: std::net::IpAddr| address.is_loopback())
        }
        #[cfg(unix)]
        Host::Unix(_) => true,
    }
}

/// Joins the parts of an address.
fn join<'p>(
    scheme: &str,
    account: Option<&str>,
    place: &str,
    parameters: impl Iterator<Item = &'p (&'p str, &'p str)>,
) -> String {
    let account = account.map(|account| format!("{account}@")).unwrap_or_default();
    let parameters: Vec<String> = parameters.map(|(name, value)| format!("{name}={value}")).collect();
    let query = if parameters.is_empty() { String::new() } else { format!("?{}", parameters.join("&")) };
    format!("{scheme}{account}{place}{query}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rejects_password_in_setting() {
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

    /// Any character in a password is either unambiguous or makes the address invalid.
    #[test]
    fn password_characters_are_unambiguous() {
        let printable = || (0x21..0x7fu8).map(char::from);
        let pairs = printable().flat_map(|first| printable().map(move |second| (first, second)));
        let places = pairs.flat_map(|(first, second)| {
            let password = format!("k{first}3{second}y");
            [format!("bench:{password}@db.plant/logs"), format!("bench@db.plant/logs?password={password}")]
                .map(|rest| (first, second, format!("postgres://{rest}")))
        });
        for (first, second, given) in places {
            match ServerAddress::from_environment(&given) {
                Ok(address) => {
                    let shown = format!("{address} {} {address:?}", address.name());
                    assert!(shown.starts_with("postgres://bench@db.plant/logs db.plant/logs "), "{given}: {shown}");
                    assert!(address.has_password() && !shown.contains(&format!("k{first}3")), "{given}: {shown}");
                }
                Err(error) => {
                    assert!([first, second].iter().any(|own| ['@', '/', '?', '&'].contains(own)), "{given}: {error}");
                    assert_eq!(error, ServerAddressError::Ambiguous, "{given}");
                }
            }
        }
        let mode = "postgres://bench@db.plant/logs?password=k3y&sslmode=s3cret";
        assert_eq!(ServerAddress::from_environment(mode), Err(ServerAddressError::Ambiguous));
        let escaped = ServerAddress::from_environment("postgres://bench:p%40%2F%3Fw@db.plant/logs").unwrap();
        assert_eq!(escaped.password.unwrap().reveal(), "p@/?w");
    }

    #[test]
    fn rejects_unknown_parameters() {
        for name in ["passwor%64", "options", "hostaddr"] {
            let unknown = ServerAddressError::UnknownParameter { name: name.to_owned() };
            let text = format!("postgres://localhost/x?sslmode=disable&{name}=10.0.0.5");
            assert_eq!(ServerAddress::from_environment(&text), Err(unknown));
        }
        let text = "postgres://localhost/x?host=db.plant&target_session_attrs=read-write";
        let address = ServerAddress::from_setting(text).unwrap();
        assert_eq!((address.to_string().as_str(), address.encryption), (text, Encryption::Verified(None)));
    }

    #[test]
    fn encrypts_remote_connections_by_default() {
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
    fn rejects_invalid_addresses() {
        for bad in ["", "db.plant", "host=db.plant password=x", "mysql://db.plant/x", "postgres://", "postgres:///x"] {
            assert_eq!(ServerAddress::from_setting(bad), Err(ServerAddressError::NotAnAddress), "{bad}");
        }
    }
}
