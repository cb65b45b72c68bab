//! Test support: an adapter that is reached over a network like a real one.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use encoder_studio::buses::bridge::protocol::{Receiver, Request};
use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::sim::ByteDevice;
use encoder_studio::units::Moment;

/// An adapter on a TCP port that serves one connection at a time.
pub(crate) struct ServedDevice {
    port: u16,
    /// The requests that were received.
    heard: Arc<Mutex<Vec<Request>>>,
    /// Whether the connection must be closed.
    cut: Arc<Mutex<bool>>,
    /// The adapter that must replace the current one.
    other: Arc<Mutex<Option<Adapter>>>,
}

impl ServedDevice {
    pub(crate) fn new(query: &str) -> Self {
        let mut adapter = adapter(query);
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let served = ServedDevice {
            port: listener.local_addr().unwrap().port(),
            heard: Arc::default(),
            cut: Arc::default(),
            other: Arc::default(),
        };
        let (heard, cut, other) = (served.heard.clone(), served.cut.clone(), served.other.clone());
        std::thread::spawn(move || {
            let began = Instant::now();
            for stream in listener.incoming() {
                let now = || Moment::from_elapsed(began.elapsed());
                serve(stream.unwrap(), &mut adapter, &heard, (&cut, &other), &now);
            }
        });
        served
    }

    pub(crate) fn link(&self) -> String {
        format!("bridge:tcp:127.0.0.1:{}", self.port)
    }

    /// Closes the current connection.
    pub(crate) fn cut(&self) {
        *self.cut.lock().unwrap() = true;
    }

    /// Replaces the device behind the connection and waits until that is done.
    pub(crate) fn exchange(&self, query: &str) {
        *self.other.lock().unwrap() = Some(adapter(query));
        while self.other.lock().unwrap().is_some() {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    pub(crate) fn requested_frame(&self, request: &Request) -> usize {
        self.heard.lock().unwrap().iter().filter(|own| *own == request).count()
    }
}

fn adapter(query: &str) -> Adapter {
    let pair = |item: &str| item.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
    let pairs: Vec<_> = query.split('&').filter_map(pair).collect();
    Adapter::from_pairs(&pairs, attachable_kinds()).unwrap()
}

fn serve(
    mut stream: TcpStream,
    adapter: &mut Adapter,
    heard: &Mutex<Vec<Request>>,
    (cut, other): (&Mutex<bool>, &Mutex<Option<Adapter>>),
    now: &dyn Fn() -> Moment,
) {
    stream.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
    adapter.connect(now());
    let mut receiver = Receiver::default();
    let mut buffer = [0; 512];
    while !std::mem::take(&mut *cut.lock().unwrap()) {
        let mut other = other.lock().unwrap();
        if let Some(other) = other.take() {
            *adapter = other;
            adapter.connect(now());
            // Another encoder is on the same adapter, which keeps its settings.
            let heard = heard.lock().unwrap();
            let set = |own: &&Request| matches!(own, Request::Supply { .. } | Request::BissConfig { .. });
            heard.iter().filter(set).for_each(|own| adapter.on_bytes(now(), &own.emit(0).emit()));
            std::thread::sleep(Duration::from_millis(300));
            let _ = adapter.poll(now());
        }
        drop(other);
        match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => {
                adapter.on_bytes(now(), &buffer[..count]);
                receiver.push(&buffer[..count]);
                let requests =
                    std::iter::from_fn(|| receiver.next_packet()).filter_map(|own| Request::parse(&own).ok());
                heard.lock().unwrap().extend(requests);
            }
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => return,
        }
        if stream.write_all(&adapter.poll(now())).is_err() {
            return;
        }
    }
}
