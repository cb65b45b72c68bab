//! Parameter words in the process data. A request is repeated until its reply has arrived (reference, section 6).

use std::fmt;

use super::process_data::ByteOrder;

/// Parameter words of the process data, eight bytes in each direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Pkw {
    /// PKE: task or answer in bits 15 to 12, SPM in bit 11, and the parameter number in the other bits.
    pub pke: u16,
    /// IND: index of the array element.
    pub ind: u16,
    /// PWE: value of the parameter. A 16-bit value is in the lower half.
    pub pwe: u32,
}

/// Task in a request, in bits 15 to 12 of PKE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Task {
    /// No task.
    None = 0,
    /// Reads a parameter.
    Read = 1,
    /// Writes a word.
    WriteWord = 2,
    /// Writes a double word.
    WriteDouble = 3,
    /// Reads an array element. An element of a string contains four characters.
    ReadElement = 6,
    /// Writes a word element of an array.
    WriteElementWord = 7,
    /// Writes a double-word element of an array.
    WriteElementDouble = 8,
    /// Reads the number of array elements.
    Count = 9,
}

/// Answer in a reply. The text of the manual wrongly gives answers the same numbers as requests (reference, section
/// 8.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Answer {
    /// Answer 0: nothing was requested.
    None,
    /// Answer 1, or 4 for an array: the value as a word.
    Word(u16),
    /// Answer 2, or 5 for an array: the value as a double word.
    Double(u32),
    /// Answer 6: the number of array elements.
    Elements(u32),
    /// Answer 7: the request was rejected.
    Refused(PkwError),
    /// Any other number.
    Unknown,
}

/// Reason why a request was rejected. Unknown codes are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PkwError(u32);

const NUMBER: u16 = 0x07FF;

impl Task {
    /// All tasks.
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

    /// Returns the task number.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Returns the task name.
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

    /// Returns whether this answer is possible for the task. A read can be answered with a word or a double word.
    const fn accepts_answer(self, answer: u8) -> bool {
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
    /// Builds a request for a parameter. Only the low 11 bits of the number are used and, for a word, only the low 16
    /// bits of the value.
    pub const fn request(task: Task, number: u16, element: u16, value: u32) -> Self {
        Pkw { pke: (task.code() as u16) << 12 | number & NUMBER, ind: element, pwe: value }
    }

    /// Parses parameter words from eight bytes.
    pub const fn parse(bytes: [u8; 8], order: ByteOrder) -> Self {
        let [k0, k1, i0, i1, value @ ..] = bytes;
        Pkw { pke: order.u16([k0, k1]), ind: order.u16([i0, i1]), pwe: order.u32(value) }
    }

    /// Encodes the parameter words as eight bytes.
    pub const fn emit(self, order: ByteOrder) -> [u8; 8] {
        let [k0, k1] = order.encode_u16(self.pke);
        let [i0, i1] = order.encode_u16(self.ind);
        let [a, b, c, d] = order.encode_u32(self.pwe);
        [k0, k1, i0, i1, a, b, c, d]
    }

    /// Returns the parameter number.
    pub const fn number(self) -> u16 {
        self.pke & NUMBER
    }

    /// Returns the task of a request, or `None` if its number is undefined.
    pub fn task(self) -> Option<Task> {
        Task::ALL.into_iter().find(|task| task.code() == self.code())
    }

    /// Returns the answer of a reply.
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

    /// Returns the answer if this is a reply to `request`. The request must be repeated until then. Before the same
    /// request can be sent again, [`Task::None`] must be sent and answered.
    pub fn answer_to(self, request: Pkw) -> Option<Answer> {
        let task = request.task()?;
        let same = task == Task::None || self.number() == request.number();
        (same && task.accepts_answer(self.code())).then(|| self.answer())
    }

    const fn code(self) -> u8 {
        (self.pke >> 12) as u8
    }
}

impl PkwError {
    /// Error 0: the parameter does not exist.
    pub const NO_PARAMETER: PkwError = PkwError(0);
    /// Error 1: the parameter is read-only.
    pub const READ_ONLY: PkwError = PkwError(1);
    /// Error 2: the value is outside the limits.
    pub const RANGE: PkwError = PkwError(2);
    /// Error 3: the string or array has no such element.
    pub const NO_ELEMENT: PkwError = PkwError(3);
    /// Error 4: the parameter has no elements.
    pub const NO_ARRAY: PkwError = PkwError(4);
    /// Error 5: a word was used instead of a double word or vice versa, or the parameter is a string.
    pub const TYPE: PkwError = PkwError(5);
    /// Error 17: the request is not possible in this state.
    pub const STATE: PkwError = PkwError(17);
    /// Error 18: any other reason.
    pub const OTHER: PkwError = PkwError(18);

    /// Creates an error from an error code, even an unknown one.
    pub const fn new(code: u32) -> Self {
        PkwError(code)
    }

    /// Returns the code.
    pub const fn code(self) -> u32 {
        self.0
    }

    /// Returns the meaning of the error code.
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
