//! How the user's name is recorded in logbook entries: in full, as initials, or not at all. Plant rules may forbid
//! names.

use std::sync::atomic::{AtomicU8, Ordering};

use serde::{Deserialize, Serialize};

/// How the user's name is recorded in the entries of this process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum UserName {
    /// The system user name.
    #[default]
    Full,
    /// The initials of the user's real name, or of the user name if the real name is unknown.
    Initials,
    Off,
}

/// The setting for all entries of this process, which belong to a single user. It is 0 until the settings have been
/// read.
static USER_NAME_SETTING: AtomicU8 = AtomicU8::new(0);

impl UserName {
    /// Applies this setting to all further entries of this process.
    pub fn apply(self) {
        USER_NAME_SETTING.store(self as u8, Ordering::Relaxed);
    }

    fn applied() -> Self {
        let choices = [UserName::Full, UserName::Initials, UserName::Off];
        choices
            .into_iter()
            .find(|choice| *choice as u8 == USER_NAME_SETTING.load(Ordering::Relaxed))
            .unwrap_or_default()
    }

    fn of(self, user_name: Option<String>, real_name: Option<String>) -> Option<String> {
        let user_name = user_name.filter(|name| !name.is_empty());
        match self {
            UserName::Full => user_name,
            UserName::Initials => {
                let letters = initials(&real_name.unwrap_or_default());
                Some(letters).filter(|letters| !letters.is_empty()).or_else(|| Some(initials(&user_name?)))
            }
            UserName::Off => None,
        }
    }
}

/// Returns the user's name as recorded in the entries of this process.
pub(super) fn of_this_process() -> Option<String> {
    UserName::applied().of(whoami::username().ok(), whoami::realname().ok())
}

fn initials(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric());
    words.filter_map(|word| word.chars().next()).flat_map(char::to_uppercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_full_abbreviated_or_omitted_names() {
        let name = |choice: UserName, user: &str, real: &str| {
            let real = (!real.is_empty()).then(|| real.to_owned());
            choice.of(Some(user.to_owned()), real).unwrap_or_default()
        };
        assert_eq!(name(UserName::Full, "mmueller", "Max Müller"), "mmueller");
        assert_eq!(name(UserName::Initials, "mmueller", "Max Müller"), "MM");
        assert_eq!(name(UserName::Initials, "åsa.van-dyk", ""), "ÅVD");
        assert_eq!(name(UserName::Initials, "x", "  ,,,"), "X", "an empty name in the system's list");
        assert_eq!(name(UserName::Off, "mmueller", "Max Müller"), "");
        assert_eq!(name(UserName::Full, "", "Max"), "");
    }
}
