//! The bytes of a Novo encoder: `R` and an address ask for a word, `W`, an address and a word set one. The reply is the word
//! that stands there, and the exclusive or of request and word.

/// The kind in profiles and on the command line.
pub(crate) const KIND: &str = "novo";
/// Where the serial number stands.
pub(crate) const SERIAL: u8 = 0x01;
/// Where the position stands: a turn has [`TURN`] steps, and it goes round after sixteen.
pub(crate) const POSITION: u8 = 0x03;
/// Where the first of the [`ITEMS`] stands.
pub(crate) const FIRST: u8 = 0x10;
/// Steps of a turn.
pub(crate) const TURN: u16 = 4096;
/// What it keeps: each a word, one behind the other.
pub(crate) const ITEMS: [&str; 4] = ["zero", "filter", "least", "greatest"];
/// Bytes of a reply.
pub(crate) const REPLY: usize = 3;

/// What it keeps, in the order of [`ITEMS`].
pub(crate) type Values = [u16; ITEMS.len()];

/// What is asked of it.
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

    /// A whole request; `None` of anything else.
    pub(crate) fn parse(bytes: &[u8]) -> Option<Self> {
        match *bytes {
            [b'R', address] => Some(Request::Read(address)),
            [b'W', address, high, low] => Some(Request::Write(address, u16::from_be_bytes([high, low]))),
            _ => None,
        }
    }
}

/// The reply to a request.
pub(crate) fn reply(request: Request, word: u16) -> [u8; REPLY] {
    let [high, low] = word.to_be_bytes();
    [high, low, request.emit().iter().fold(high ^ low, |check, byte| check ^ byte)]
}

/// The word of a reply; `None` where it is damaged, or answers something else.
pub(crate) fn parse_reply(request: Request, bytes: &[u8]) -> Option<u16> {
    let word = u16::from_be_bytes([*bytes.first()?, *bytes.get(1)?]);
    (reply(request, word) == bytes).then_some(word)
}

/// Where an item stands.
pub(crate) fn address_of(item: usize) -> u8 {
    ITEMS.iter().zip(FIRST..).nth(item).map_or(FIRST, |(_, address)| address)
}

/// What an item is called.
pub(crate) fn name_of(item: usize) -> &'static str {
    ITEMS.get(item).copied().unwrap_or_default()
}
