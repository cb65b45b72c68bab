//! Parameter words in the process data: a request is repeated until its reply has come (reference 6).

use std::fmt;

use super::process_data::ByteOrder;

/// Eight bytes, either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Pkw {
    /// PKE: what is asked or answered (bits 15 to 12), SPM (bit 11), the parameter's number.
    pub pke: u16,
    /// IND: the element of an array.
    pub ind: u16,
    /// PWE: the value; of a word the lower half.
    pub pwe: u32,
}

/// What is asked: bits 15 to 12 of PKE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Task {
    /// Nothing.
    None = 0,
    /// A parameter is read.
    Read = 1,
    /// A word is written.
    WriteWord = 2,
    /// A double word is written.
    WriteDouble = 3,
    /// An element of an array is read: four characters of a text.
    ReadElement = 6,
    /// A word of an array is written.
    WriteElementWord = 7,
    /// A double word of an array is written.
    WriteElementDouble = 8,
    /// How many elements it has.
    Count = 9,
}

/// What comes back. The manual's text names the numbers of requests for it (reference 8.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Answer {
    /// 0: nothing was asked.
    None,
    /// 1, and 4 of an array.
    Word(u16),
    /// 2, and 5 of an array.
    Double(u32),
    /// 6.
    Elements(u32),
    /// 7.
    Refused(PkwError),
    /// Another number.
    Unknown,
}

/// Why a request was refused. Codes that are not known are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PkwError(u32);

const NUMBER: u16 = 0x07FF;

impl Task {
    /// All of them.
    pub const ALL: [Task; 8] = [
        Task::None,
        Task::Read,
        Task::WriteWord,
        Task::WriteDouble,
        Task::ReadElement,
        Task::WriteElementWord,
        Task::WriteElementDouble,
        Task::Count,
    ];

    /// Its number.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// What it asks for.
    pub const fn name(self) -> &'static str {
        match self {
            Task::None => "nothing",
            Task::Read => "read",
            Task::WriteWord => "write word",
            Task::WriteDouble => "write double word",
            Task::ReadElement => "read element",
            Task::WriteElementWord => "write word of element",
            Task::WriteElementDouble => "write double word of element",
            Task::Count => "number of elements",
        }
    }

    /// Whether an answer may be one to this. A value may come as a word or a double word where it is read.
    const fn takes(self, answer: u8) -> bool {
        match self {
            Task::None => answer == 0,
            Task::Read => matches!(answer, 1 | 2 | 7),
            Task::WriteWord => matches!(answer, 1 | 7),
            Task::WriteDouble => matches!(answer, 2 | 7),
            Task::ReadElement => matches!(answer, 4 | 5 | 7),
            Task::WriteElementWord => matches!(answer, 4 | 7),
            Task::WriteElementDouble => matches!(answer, 5 | 7),
            Task::Count => matches!(answer, 6 | 7),
        }
    }
}

impl Pkw {
    /// A request about a parameter, of which 11 bits are sent; of a word the lower 16 bits of the value.
    pub const fn request(task: Task, number: u16, element: u16, value: u32) -> Self {
        Pkw { pke: (task.number() as u16) << 12 | number & NUMBER, ind: element, pwe: value }
    }

    /// Reads eight bytes.
    pub const fn parse(bytes: [u8; 8], order: ByteOrder) -> Self {
        let [k0, k1, i0, i1, value @ ..] = bytes;
        Pkw { pke: order.u16([k0, k1]), ind: order.u16([i0, i1]), pwe: order.u32(value) }
    }

    /// Its bytes.
    pub const fn emit(self, order: ByteOrder) -> [u8; 8] {
        let [k0, k1] = order.of_u16(self.pke);
        let [i0, i1] = order.of_u16(self.ind);
        let [a, b, c, d] = order.of_u32(self.pwe);
        [k0, k1, i0, i1, a, b, c, d]
    }

    /// The parameter it is about.
    pub const fn number(self) -> u16 {
        self.pke & NUMBER
    }

    /// What a request asks for; `None` for a number that there is not.
    pub fn task(self) -> Option<Task> {
        Task::ALL.into_iter().find(|task| task.number() == self.code())
    }

    /// What a reply says.
    pub const fn answer(self) -> Answer {
        match self.code() {
            0 => Answer::None,
            1 | 4 => Answer::Word(self.pwe as u16),
            2 | 5 => Answer::Double(self.pwe),
            6 => Answer::Elements(self.pwe),
            7 => Answer::Refused(PkwError(self.pwe & 0xFFFF)),
            _ => Answer::Unknown,
        }
    }

    /// The answer in this reply, where it is one to that request. Until then the request is repeated; before the same one is
    /// made again, [`Task::None`] has to be made and answered.
    pub fn answer_to(self, request: Pkw) -> Option<Answer> {
        let task = request.task()?;
        let same = task == Task::None || self.number() == request.number();
        (same && task.takes(self.code())).then(|| self.answer())
    }

    const fn code(self) -> u8 {
        (self.pke >> 12) as u8
    }
}

impl PkwError {
    /// 0: there is no such parameter.
    pub const NO_PARAMETER: PkwError = PkwError(0);
    /// 1: it can only be read.
    pub const READ_ONLY: PkwError = PkwError(1);
    /// 2: beyond its limits.
    pub const RANGE: PkwError = PkwError(2);
    /// 3: the text or array ends before.
    pub const NO_ELEMENT: PkwError = PkwError(3);
    /// 4: it has no elements.
    pub const NO_ARRAY: PkwError = PkwError(4);
    /// 5: a word where it is a double word, or the other way; a text.
    pub const TYPE: PkwError = PkwError(5);
    /// 17: not in this state.
    pub const STATE: PkwError = PkwError(17);
    /// 18: whatever else.
    pub const OTHER: PkwError = PkwError(18);

    /// Any number is a code.
    pub const fn new(code: u32) -> Self {
        PkwError(code)
    }

    /// Its number.
    pub const fn code(self) -> u32 {
        self.0
    }

    /// What it says.
    pub const fn meaning(self) -> &'static str {
        match self.0 {
            0 => "no such parameter",
            1 => "read-only",
            2 => "beyond its limits",
            3 => "no such element",
            4 => "no array",
            5 => "wrong type",
            6 => "may only be reset",
            17 => "not possible in the present state",
            18 => "another error",
            _ => "unknown error",
        }
    }
}

impl fmt::Display for PkwError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.meaning(), self.0)
    }
}
