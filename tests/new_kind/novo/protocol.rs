//! The protocol of a Novo encoder. `R` and an address read a word; `W`, an address and a word write it. The reply is
//! the word at that address, followed by the XOR of all bytes of the request and the word.

/// The name of the kind in profiles and on the command line.
pub(crate) const KIND: &str = "novo";
/// Address of the serial number.
pub(crate) const SERIAL: u8 = 0x01;
/// Address of the position. A turn has [`TURN`] steps, and the counter overflows after sixteen turns.
pub(crate) const POSITION: u8 = 0x03;
/// Address of the first of the [`ITEMS`].
pub(crate) const FIRST: u8 = 0x10;
/// Number of steps per turn.
pub(crate) const TURN: u16 = 4096;
/// Names of the stored values. Each value is a word, and their addresses are consecutive.
pub(crate) const ITEMS: [&str; 4] = ["zero", "filter", "least", "greatest"];
/// Length of a reply in bytes.
pub(crate) const REPLY: usize = 3;

/// The stored values, in the order of [`ITEMS`].
pub(crate) type Values = [u16; ITEMS.len()];

/// A request to the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Request {
    Read(u8),
    Write(u8, u16),
}

impl Request {
    pub(crate) fn emit(self) -> Vec<u8> {
        match self {
            Request::Read(address) => vec![b'R', address],
            Request::Write(address, word) => [&[b'W', address], &word.to_be_bytes()[..]].concat(),
        }
    }

    /// Parses a complete request. Returns `None` if it is invalid.
    pub(crate) fn parse(bytes: &[u8]) -> Option<Self> {
        match *bytes {
            [b'R', address] => Some(Request::Read(address)),
            [b'W', address, high, low] => Some(Request::Write(address, u16::from_be_bytes([high, low]))),
            _ => None,
        }
    }
}

/// Returns the reply to a request.
pub(crate) fn reply(request: Request, word: u16) -> [u8; REPLY] {
    let [high, low] = word.to_be_bytes();
    [high, low, request.emit().iter().fold(high ^ low, |check, byte| check ^ byte)]
}

/// Returns the word in a reply, or `None` if the reply is damaged or belongs to another request.
pub(crate) fn parse_reply(request: Request, bytes: &[u8]) -> Option<u16> {
    let word = u16::from_be_bytes([*bytes.first()?, *bytes.get(1)?]);
    (reply(request, word) == bytes).then_some(word)
}

/// Returns the address of an item.
pub(crate) fn item_address(item: usize) -> u8 {
    ITEMS.iter().zip(FIRST..).nth(item).map_or(FIRST, |(_, address)| address)
}

/// Returns the name of an item.
pub(crate) fn name_of(item: usize) -> &'static str {
    ITEMS.get(item).copied().unwrap_or_default()
}
