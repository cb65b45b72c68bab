//! A proxy that records the requests to a device over TCP. Each CIP request is recorded in hexadecimal.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

use super::support::{Bench, Ran, Simulated};

/// A virtual device behind a recording proxy.
pub(crate) struct TappedDevice {
    device: Simulated,
    url: String,
    heard: Arc<Mutex<Vec<String>>>,
}

/// Length of a frame header in bytes (reference 7).
const HEADER: usize = 24;
/// Number of bytes before a request in SendRRData.
const REQUEST_OFFSET: usize = 16;

impl TappedDevice {
    /// Starts the device. `arguments` are appended to `simulate hiperdrive --listen …`.
    pub(crate) fn start(bench: &Bench, arguments: &[&str]) -> Self {
        let device = Simulated::start(bench, &[&["hiperdrive", "--listen", "127.0.0.1:0"], arguments].concat());
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("enip:{}", listener.local_addr().unwrap());
        let heard = Arc::new(Mutex::new(Vec::new()));
        let (behind, log) = (device.place.clone(), heard.clone());
        thread::spawn(move || {
            for host in listener.incoming().map_while(Result::ok) {
                let Ok(device) = TcpStream::connect(&behind) else { return };
                let (answers, asks) = (device.try_clone().unwrap(), host.try_clone().unwrap());
                let log = log.clone();
                thread::spawn(move || forward(answers, host, |_| {}));
                thread::spawn(move || listen(asks, device, &log));
            }
        });
        TappedDevice { device, url, heard }
    }

    /// Returns the requests since the last call.
    pub(crate) fn heard(&self) -> Vec<String> {
        std::mem::take(&mut self.heard.lock().unwrap())
    }

    /// Returns the requests since the last call that set a value (service 10h).
    pub(crate) fn sets(&self) -> Vec<String> {
        self.heard().into_iter().filter(|request| request.starts_with("10 ")).collect()
    }

    /// Runs a command with a link to the device and JSON output.
    pub(crate) fn ask(&self, bench: &Bench, words: &[&str]) -> Ran {
        bench.run(&[words, &["--link", &self.url, "--json"]].concat())
    }

    /// Sends a request directly to the device, as another host would, and returns the reply.
    pub(crate) fn request(&self, request: &[u8]) -> Vec<u8> {
        let mut device = TcpStream::connect(&self.device.place).unwrap();
        let mut send = |command: u16, session: [u8; 4], data: &[u8]| {
            let mut frame = command.to_le_bytes().to_vec();
            frame.extend(u16::try_from(data.len()).unwrap().to_le_bytes());
            frame.extend(session);
            frame.resize(HEADER, 0);
            frame.extend(data);
            device.write_all(&frame).unwrap();
            let mut header = [0; HEADER];
            device.read_exact(&mut header).unwrap();
            let mut data = vec![0; usize::from(u16::from_le_bytes([header[2], header[3]]))];
            device.read_exact(&mut data).unwrap();
            ([header[4], header[5], header[6], header[7]], data)
        };
        // RegisterSession, version 1.
        let (session, _) = send(0x65, [0; 4], &[1, 0, 0, 0]);
        let mut data = vec![0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0xB2, 0];
        data.extend(u16::try_from(request.len()).unwrap().to_le_bytes());
        data.extend(request);
        send(0x6F, session, &data).1.split_off(REQUEST_OFFSET)
    }

    /// Returns the link that bypasses the proxy.
    pub(crate) fn url(&self) -> String {
        format!("enip:{}", self.device.place)
    }
}

fn listen(asks: TcpStream, device: TcpStream, log: &Mutex<Vec<String>>) {
    let mut pending = Vec::new();
    forward(asks, device, |bytes| {
        pending.extend_from_slice(bytes);
        while pending.len() >= HEADER {
            let length = HEADER + usize::from(u16::from_le_bytes([pending[2], pending[3]]));
            if pending.len() < length {
                break;
            }
            let frame: Vec<u8> = pending.drain(..length).collect();
            if frame[0] == 0x6F {
                let request = &frame[HEADER + REQUEST_OFFSET..];
                let hex: Vec<String> = request.iter().map(|byte| format!("{byte:02X}")).collect();
                log.lock().unwrap().push(hex.join(" "));
            }
        }
    });
}

fn forward(mut from: TcpStream, mut to: TcpStream, mut heard: impl FnMut(&[u8])) {
    let mut bytes = [0; 4096];
    while let Ok(count) = from.read(&mut bytes) {
        if count == 0 {
            break;
        }
        heard(&bytes[..count]);
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    let _ = to.shutdown(Shutdown::Both);
}
