//! A connection to the logbook server. Each call has a time limit, and all calls share a deadline. A failed connection
//! is not used again.

use std::future::Future;
use std::path::Path;
use std::time::{Duration, Instant};

use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject as _;
use rustls::{ClientConfig, RootCertStore};
use tokio::runtime::{Builder, Runtime};
use tokio_postgres::config::{Host, SslMode};
use tokio_postgres::{Config, NoTls};
use tokio_postgres_rustls::MakeRustlsConnect;

use super::address::{DEFAULT_PORT, Encryption, Password, ServerAddress};
use super::error::{ServerErrorKind, UnreachableCause};

/// Maximum time for a call, regardless of the deadline for all of them.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(5);

/// Server-side timeouts, for a client that holds a lock while it is suspended or offline. They are longer than any call
/// takes.
const SESSION_OPTIONS: &str = "-c idle_in_transaction_session_timeout=6s -c statement_timeout=30s \
    -c tcp_keepalives_idle=30 -c tcp_keepalives_interval=10";

/// A connection to the logbook server.
pub(super) struct Client {
    runtime: NonBlockingRuntime,
    deadline: Instant,
    pub(super) postgres: tokio_postgres::Client,
}

/// A runtime that does not wait for a host name lookup when it is dropped.
struct NonBlockingRuntime(Option<Runtime>);

impl Client {
    /// Connects to a server. The deadline applies to the connection and to all later calls.
    pub(super) fn connect(
        address: &ServerAddress,
        password: Option<&Password>,
        deadline: Instant,
    ) -> Result<Self, ServerErrorKind> {
        let runtime = NonBlockingRuntime::new()?;
        let mut config = address.config.clone();
        // A missing password needs no special case, because the server rejects an empty one.
        config
            .password(password.map_or("", Password::reveal))
            .application_name("encoder-studio")
            .options(SESSION_OPTIONS);
        let connected = runtime.run(deadline, async {
            check_host(&config).await?;
            match &address.encryption {
                Encryption::Off => {
                    let (client, connection) = config.ssl_mode(SslMode::Disable).connect(NoTls).await?;
                    tokio::spawn(connection);
                    Ok(client)
                }
                Encryption::Verified(authorities) => {
                    let tls = MakeRustlsConnect::new(tls_config(authorities.as_deref())?);
                    let (client, connection) =
                        config.ssl_mode(SslMode::Require).connect(tls).await.map_err(encryption_error)?;
                    tokio::spawn(connection);
                    Ok(client)
                }
            }
        });
        let postgres = connected.map_err(|problem| match problem {
            ServerErrorKind::WrongPassword if password.is_none() => ServerErrorKind::PasswordMissing,
            problem => problem,
        })?;
        Ok(Client { runtime, deadline, postgres })
    }

    /// Runs one or more requests within the time limit for a single call.
    pub(super) fn run<'c, T, F>(
        &'c mut self,
        requests: impl FnOnce(&'c mut tokio_postgres::Client) -> F,
    ) -> Result<T, ServerErrorKind>
    where
        F: Future<Output = Result<T, ServerErrorKind>>,
    {
        self.runtime.run(self.deadline, requests(&mut self.postgres))
    }

    pub(super) fn set_deadline(&mut self, deadline: Instant) {
        self.deadline = deadline;
    }

    pub(super) fn time_left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }
}

impl NonBlockingRuntime {
    fn new() -> Result<Self, ServerErrorKind> {
        let runtime = Builder::new_current_thread().enable_all().build();
        runtime
            .map(|runtime| NonBlockingRuntime(Some(runtime)))
            .map_err(|error| ServerErrorKind::Unreachable { why: UnreachableCause::from_io(&error) })
    }

    fn run<T>(
        &self,
        deadline: Instant,
        work: impl Future<Output = Result<T, ServerErrorKind>>,
    ) -> Result<T, ServerErrorKind> {
        let Some(runtime) = &self.0 else { return Err(ServerErrorKind::NoReply) };
        let limit = deadline.saturating_duration_since(Instant::now()).min(REQUEST_TIMEOUT);
        runtime.block_on(async { tokio::time::timeout(limit, work).await.unwrap_or(Err(ServerErrorKind::NoReply)) })
    }
}

impl Drop for NonBlockingRuntime {
    fn drop(&mut self) {
        if let Some(runtime) = self.0.take() {
            runtime.shutdown_background();
        }
    }
}

/// Checks that the host name resolves to an address.
async fn check_host(config: &Config) -> Result<(), ServerErrorKind> {
    let port = config.get_ports().first().copied().unwrap_or(DEFAULT_PORT);
    match config.get_hosts().first() {
        Some(Host::Tcp(name)) if config.get_hostaddrs().is_empty() => {
            let found = tokio::net::lookup_host((name.as_str(), port)).await;
            found.map(drop).map_err(|_| ServerErrorKind::UnknownHost)
        }
        _ => Ok(()),
    }
}

/// Returns the TLS settings: the certificate must be valid for the host and signed by an authority in the file or of
/// the system.
fn tls_config(authorities: Option<&Path>) -> Result<ClientConfig, ServerErrorKind> {
    let mut roots = RootCertStore::empty();
    match authorities {
        Some(path) => {
            let bad = |why: String| ServerErrorKind::Certificates { path: path.to_owned(), why };
            for certificate in CertificateDer::pem_file_iter(path).map_err(|error| bad(error.to_string()))? {
                let certificate = certificate.map_err(|error| bad(error.to_string()))?;
                roots.add(certificate).map_err(|error| bad(error.to_string()))?;
            }
            if roots.is_empty() {
                return Err(bad("it is empty".to_owned()));
            }
        }
        None => {
            roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
        }
    }
    let provider = rustls::crypto::ring::default_provider().into();
    let builder = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| ServerErrorKind::Encryption { why: error.to_string() })?;
    Ok(builder.with_root_certificates(roots).with_no_client_auth())
}

/// Returns the reason why an encrypted connection failed. A server without TLS is reported as a distinct error.
fn encryption_error(error: tokio_postgres::Error) -> ServerErrorKind {
    match ServerErrorKind::from(error) {
        ServerErrorKind::Database { code: None, what } => ServerErrorKind::Encryption { why: what },
        problem => problem,
    }
}
