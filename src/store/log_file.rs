//! The log file, which preserves the content of the log panel after the window closes. A separate thread writes the
//! file, so a slow disk does not block other threads. Lines that do not fit into the queue are dropped, and their
//! number is written when the disk responds again. A file that has grown large is renamed, and a new one is started.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};
use tracing::Level;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::{fmt, registry};

/// Size in bytes above which a new log file is started.
const MAX_LOG_BYTES: u64 = 1 << 20;

/// Maximum number of lines waiting to be written.
const QUEUE_CAPACITY: usize = 1024;

/// Maximum time to wait for the last lines when the program ends.
const FLUSH_TIMEOUT: Duration = Duration::from_millis(500);

/// A handle that queues lines for the log file without blocking. All clones write to the same file.
#[derive(Clone, Debug)]
pub struct LogFile {
    queue: Sender<LogRequest>,
    dropped: Arc<AtomicU64>,
}

#[derive(Debug)]
enum LogRequest {
    Line(Vec<u8>),
    /// Requests a confirmation after all earlier lines have been written.
    Flush(Sender<()>),
}

impl LogFile {
    /// Starts a log file that records the program's messages from level "info" and the warnings of its libraries. The
    /// file and its folder are created if they are missing. If the file cannot be opened, the program runs without a
    /// log file.
    ///
    /// # Errors
    /// Returns an error if the thread cannot be started.
    pub fn start(path: &Path) -> io::Result<Self> {
        let own = path.to_owned();
        let log = Self::spawn_writer(move || RotatingFile::open(&own, MAX_LOG_BYTES), QUEUE_CAPACITY)?;
        let lines = log.clone();
        let layer = fmt::layer().with_writer(move || lines.clone()).with_ansi(false).with_target(false);
        let filter = Targets::new().with_default(Level::WARN).with_target(env!("CARGO_CRATE_NAME"), Level::INFO);
        let _ = tracing::subscriber::set_global_default(registry().with(layer).with(filter));
        tracing::info!("encoder-studio {}", env!("CARGO_PKG_VERSION"));
        Ok(log)
    }

    fn spawn_writer<W: Write>(open: impl FnOnce() -> io::Result<W> + Send + 'static, queue: usize) -> io::Result<Self> {
        let (sender, orders) = bounded(queue);
        let dropped = Arc::new(AtomicU64::new(0));
        let counted = dropped.clone();
        thread::Builder::new().name("log".to_owned()).spawn(move || {
            // Opening the file may also have to wait for the disk.
            if let Ok(file) = open() {
                write_all(file, &orders, &counted);
            }
        })?;
        Ok(LogFile { queue: sender, dropped })
    }

    fn write_line(&self, line: &[u8]) {
        if self.queue.try_send(LogRequest::Line(line.to_owned())).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Waits until everything has been written to the file, or until a timeout if the disk hangs.
    pub fn wait_until_written(&self) {
        let (done, waited) = bounded(1);
        if self.queue.send_timeout(LogRequest::Flush(done), FLUSH_TIMEOUT).is_ok() {
            let _ = waited.recv_timeout(FLUSH_TIMEOUT);
        }
    }
}

fn write_all(mut file: impl Write, orders: &Receiver<LogRequest>, dropped: &AtomicU64) {
    for order in orders {
        match order {
            LogRequest::Line(line) => {
                // Lines that cannot be written count as missing.
                if file.write_all(&line).is_err() {
                    dropped.fetch_add(1, Ordering::Relaxed);
                    continue;
                }
                let missing = dropped.swap(0, Ordering::Relaxed);
                if missing > 0 && writeln!(file, "({missing} lines are missing)").is_err() {
                    dropped.fetch_add(missing, Ordering::Relaxed);
                }
            }
            LogRequest::Flush(done) => {
                let _ = file.flush();
                let _ = done.try_send(());
            }
        }
    }
}

/// Queues each call of `write` as one line.
impl Write for LogFile {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        self.write_line(line);
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A log file that is renamed and replaced when it becomes too large.
struct RotatingFile {
    path: PathBuf,
    large: u64,
    file: File,
    length: u64,
}

impl RotatingFile {
    fn open(path: &Path, large: u64) -> io::Result<Self> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        let length = file.metadata()?.len();
        Ok(RotatingFile { path: path.to_owned(), large, file, length })
    }

    fn start_new_logbook(&mut self) -> io::Result<()> {
        fs::rename(&self.path, self.path.with_extension("old.log"))?;
        *self = Self::open(&self.path, self.large)?;
        Ok(())
    }
}

impl Write for RotatingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let full = self.length > 0 && self.length.saturating_add(bytes.len() as u64) > self.large;
        if full && self.start_new_logbook().is_err() {
            // On some systems, renaming fails while another window has the file open. The file then grows until the
            // next attempt succeeds.
            self.length = 0;
        }
        let written = self.file.write(bytes)?;
        self.length = self.length.saturating_add(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn appends_to_existing_log() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("data").join("own.log");
        for line in ["one\n", "two\n"] {
            let log = LogFile::spawn_writer(
                {
                    let path = path.clone();
                    move || RotatingFile::open(&path, MAX_LOG_BYTES)
                },
                QUEUE_CAPACITY,
            )
            .unwrap();
            log.write_line(line.as_bytes());
            log.wait_until_written();
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), "one\ntwo\n");
    }

    #[test]
    fn rotates_large_file() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("own.log");
        let own = path.clone();
        let log = LogFile::spawn_writer(move || RotatingFile::open(&own, 8), QUEUE_CAPACITY).unwrap();
        for line in ["one\n", "two\n", "three\n", "four\n"] {
            log.write_line(line.as_bytes());
        }
        log.wait_until_written();
        assert_eq!(fs::read_to_string(path.with_extension("old.log")).unwrap(), "three\n");
        assert_eq!(fs::read_to_string(&path).unwrap(), "four\n");
    }

    /// A simulated disk that hangs until it is released.
    struct HungDisk {
        lock: Receiver<()>,
        written: Arc<Mutex<Vec<u8>>>,
    }

    impl Write for HungDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.lock.recv();
            self.written.lock().unwrap().extend(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn hung_disk_does_not_block() {
        let (release, lock) = bounded::<()>(0);
        let written = Arc::new(Mutex::new(Vec::new()));
        let log = LogFile::spawn_writer(
            {
                let written = written.clone();
                move || Ok(HungDisk { lock, written })
            },
            2,
        )
        .unwrap();
        for number in 0..10 {
            log.write_line(format!("line {number}\n").as_bytes());
        }
        // A dropped lock does not block any thread.
        drop(release);
        log.wait_until_written();
        let text = String::from_utf8(written.lock().unwrap().clone()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let (missing, kept): (Vec<&str>, Vec<&str>) = lines.iter().partition(|line| line.starts_with('('));
        let count: usize = missing[0].trim_start_matches('(').split(' ').next().unwrap().parse().unwrap();
        assert_eq!((missing.len(), kept.len() + count, kept[0]), (1, 10, "line 0"), "{text}");
    }
}
