//! Parameter words in the process data: the answers of a station (reference, section 6).

use super::parameters::string_element;
use super::station::Station;
use crate::devices::hiperdrive::protocol::{Kind, ParameterNumber, Pkw, PkwError, Task, Value};
use crate::units::Moment;

impl Station {
    pub(super) fn reply_to(&mut self, now: Moment, request: Pkw) -> Pkw {
        let reply = |code: u16, value: u32| Pkw { pke: code << 12 | request.number(), ind: request.ind, pwe: value };
        let refused = |error: PkwError| reply(7, error.code());
        let number = ParameterNumber::new(request.number());
        let Some((number, row)) = number.and_then(|number| Some((number, number.row()?))) else {
            return if request.task() == Some(Task::None) { Pkw::default() } else { refused(PkwError::NO_PARAMETER) };
        };
        let wide = row.kind.byte_length() == Some(4);
        match (request.task(), row.kind) {
            (Some(Task::None), _) => Pkw::default(),
            (Some(Task::Read), Kind::Text) => refused(PkwError::TYPE),
            (Some(Task::Read), _) => match self.read(now, number) {
                // A number of less than 32 bits fits into the lower bits.
                Ok(Value::Number(value)) => {
                    reply(if wide { 2 } else { 1 }, if wide { value as u32 } else { (value as u16).into() })
                }
                Ok(Value::Text(_)) => refused(PkwError::TYPE),
                Err(why) => refused(why.error()),
            },
            (Some(Task::WriteWord), _) if wide || row.kind == Kind::Text => refused(PkwError::TYPE),
            (Some(Task::WriteDouble), _) if !wide => refused(PkwError::TYPE),
            (Some(Task::WriteWord | Task::WriteDouble), kind) => {
                let value = match kind {
                    Kind::I32 => i64::from(request.pwe.cast_signed()),
                    Kind::I8 | Kind::I16 => i64::from((request.pwe as u16).cast_signed()),
                    _ if wide => request.pwe.into(),
                    _ => (request.pwe & 0xFFFF).into(),
                };
                match self.write(now, number, &Value::Number(value)) {
                    Ok(()) => reply(if wide { 2 } else { 1 }, request.pwe),
                    Err(why) => refused(why.error()),
                }
            }
            (Some(Task::ReadElement | Task::Count), Kind::Text) => {
                let text = match self.read(now, number) {
                    Ok(Value::Text(text)) => text,
                    Ok(Value::Number(_)) => return refused(PkwError::TYPE),
                    Err(why) => return refused(why.error()),
                };
                if request.task() == Some(Task::Count) {
                    // A string has a few dozen characters.
                    return reply(6, text.len().div_ceil(4) as u32);
                }
                string_element(&text, request.ind).map_or(refused(PkwError::NO_ELEMENT), |four| reply(5, four))
            }
            (Some(Task::WriteElementWord | Task::WriteElementDouble), Kind::Text) => refused(PkwError::READ_ONLY),
            (Some(_), _) => refused(PkwError::NO_ARRAY),
            (None, _) => refused(PkwError::OTHER),
        }
    }
}
