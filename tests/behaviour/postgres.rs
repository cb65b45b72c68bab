//! A PostgreSQL server from the Debian package, in a temporary folder and on a free port.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use encoder_studio::store::{ServerAddress, Store};
use tempfile::TempDir;

use super::support::{Bench, skip};

pub(crate) const PASSWORD: &str = "k3y-of-the-bench";
const ADMIN: &str = "k3y-of-the-administrator";
const USER: &str = "postgres";

pub(crate) struct Postgres {
    folder: TempDir,
    programs: PathBuf,
    pub(crate) port: u16,
    server: Option<Child>,
}

impl Postgres {
    /// Starts a server with the database `logs` and the user `bench`. If PostgreSQL is not installed, prints a line and
    /// returns `None`.
    pub(crate) fn start() -> Option<Self> {
        Self::start_with(&[])
    }

    pub(crate) fn start_with(options: &[&str]) -> Option<Self> {
        let Some(programs) = newest_programs() else {
            skip("PostgreSQL is not installed (/usr/lib/postgresql)");
            return None;
        };
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("password"), ADMIN).unwrap();
        if is_root() {
            let owner = format!("{USER}:");
            assert!(Command::new("chown").arg("-R").arg(owner).arg(folder.path()).status().unwrap().success());
        }
        // The port may be taken again before the server has it; nothing else here opens ports that it did not choose.
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut server = Postgres { folder, programs, port, server: None };
        let init = server
            .program("initdb")
            .args(["--username", USER, "--auth", "scram-sha-256", "--encoding", "UTF8", "--locale", "C", "--no-sync"])
            .arg("--pwfile")
            .arg(server.path("password"))
            .arg(server.path("data"))
            .output()
            .unwrap();
        assert!(init.status.success(), "{}", String::from_utf8_lossy(&init.stderr));
        server.run(options);
        server.run_sql_in_database("postgres", &format!("CREATE ROLE bench LOGIN PASSWORD '{PASSWORD}'"));
        server.run_sql_in_database("postgres", "CREATE DATABASE logs OWNER bench");
        Some(server)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Starts the server and waits until it answers.
    pub(crate) fn run(&mut self, options: &[&str]) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while Instant::now() < deadline {
            let log = fs::File::options().append(true).create(true).open(self.path("log")).unwrap();
            let mut server = self.program("postgres");
            server.arg("-D").arg(self.path("data")).arg("-k").arg(self.folder.path());
            server.args(["-p", &self.port.to_string(), "-c", "listen_addresses=127.0.0.1", "-c", "fsync=off"]);
            server.args(options).stderr(log).stdout(Stdio::null());
            self.server = Some(server.spawn().unwrap());
            // A server that was killed may still hold its memory for a moment, and then the new one ends.
            while self.server.as_mut().unwrap().try_wait().unwrap().is_none() && Instant::now() < deadline {
                if self.psql("postgres", "SELECT 1").status().unwrap().success() {
                    return;
                }
                sleep(Duration::from_millis(50));
            }
            sleep(Duration::from_millis(100));
        }
        panic!("{}", fs::read_to_string(self.path("log")).unwrap());
    }

    /// Kills the server, as a power failure would.
    pub(crate) fn kill(&mut self) {
        if let Some(mut server) = self.server.take() {
            let _ = server.kill();
            let _ = server.wait();
        }
    }

    /// Returns the address of the database, without a password.
    pub(crate) fn url(&self) -> String {
        format!("postgres://bench@127.0.0.1:{}/logs", self.port)
    }

    /// Returns a store that shares its logbook through this server.
    pub(crate) fn store_at(&self, root: &Path) -> Store {
        let store = Store::at_root(root);
        let address = self.url().replace('@', &format!(":{PASSWORD}@"));
        store.logbook_server().set_address(Some(ServerAddress::from_environment(&address)));
        store
    }

    /// Starts an SQL command as the administrator.
    pub(crate) fn start_sql(&self, sql: &str) -> Child {
        self.psql("logs", sql).spawn().unwrap()
    }

    /// Waits until a query returns one row with the given text.
    #[track_caller]
    pub(crate) fn until(&self, sql: &str, expected: &str) {
        let deadline = Instant::now() + Duration::from_secs(30);
        while self.sql(sql) != [expected] {
            assert!(Instant::now() < deadline, "{sql}: {expected}");
            sleep(Duration::from_millis(20));
        }
    }

    /// Executes SQL as the administrator and returns one line per row.
    #[track_caller]
    pub(crate) fn sql(&self, sql: &str) -> Vec<String> {
        self.run_sql_in_database("logs", sql)
    }

    #[track_caller]
    fn run_sql_in_database(&self, database: &str, sql: &str) -> Vec<String> {
        let output = self.psql(database, sql).stdout(Stdio::piped()).output().unwrap();
        assert!(output.status.success(), "{sql}");
        String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
    }

    fn psql(&self, database: &str, sql: &str) -> Command {
        let mut psql = Command::new(self.programs.join("psql"));
        psql.env("PGPASSWORD", ADMIN).stdout(Stdio::null()).stderr(Stdio::null()).args(["-X", "-At"]);
        psql.args(["-v", "ON_ERROR_STOP=1", "-c", sql]);
        psql.arg(format!("postgres://{USER}@127.0.0.1:{}/{database}", self.port));
        psql
    }

    /// Returns a command for one of PostgreSQL's programs. The server refuses to run as root.
    fn program(&self, name: &str) -> Command {
        let path = self.programs.join(name);
        let mut command = if is_root() {
            let mut setpriv = Command::new("setpriv");
            setpriv.args(["--reuid", USER, "--regid", USER, "--clear-groups"]).arg(path);
            setpriv
        } else {
            Command::new(path)
        };
        command.current_dir(self.folder.path());
        command
    }
}

impl Drop for Postgres {
    fn drop(&mut self) {
        self.kill();
    }
}

impl Bench {
    /// Runs the program with a logbook server.
    pub(crate) fn run_with_server(&self, url: &str, arguments: &[&str]) -> super::support::Ran {
        let mut command = self.program(arguments);
        command.env("ENCODER_STUDIO_LOGBOOK", url).env("PGPASSWORD", PASSWORD);
        super::support::finish(command)
    }
}

/// Returns the folder with the programs of the newest installed version.
fn newest_programs() -> Option<PathBuf> {
    let versions = fs::read_dir("/usr/lib/postgresql").ok()?.flatten();
    let number = |path: &Path| path.file_name()?.to_str()?.parse::<u32>().ok();
    let newest = versions.map(|entry| entry.path()).max_by_key(|path| number(path))?.join("bin");
    newest.join("postgres").exists().then_some(newest)
}

fn is_root() -> bool {
    let user = Command::new("id").arg("-u").output().unwrap();
    user.stdout.starts_with(b"0\n")
}
