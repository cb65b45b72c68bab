//! Tests of the virtual adapter's settings with every device that can be attached.

use crate::buses::bridge::sim::{Adapter, all_setting_names};
use crate::kinds::attachable_kinds;
use crate::sim::ConfigError;
use crate::sim::setting::query_pairs;
use proptest::prelude::*;

fn error(query: &str) -> Option<ConfigError> {
    Adapter::from_pairs(&query_pairs(query), attachable_kinds()).err()
}

#[test]
fn devices_read_their_own_settings() {
    let query = "line=low&noise=0.5&ssi-error=error:2&ssi=ahm36,st=12&supply=switched&uart=hiperface&version=2&rpm=60";
    assert_eq!(error(query), None);
    let unknown = error("lin=low").unwrap().to_string();
    let sentence = "a virtual adapter has no setting `lin`; valid settings are line, noise, ssi, ssi-error, supply, uart, \
                    version, seed, fault, firmware, ";
    assert!(unknown.starts_with(sentence), "{unknown}");
    for query in ["rpm=NaN", "noise=2", "ssi=x", "ssi-error=ERROR", "uart=on", "version=256", "seed=x"] {
        assert!(matches!(error(query), Some(ConfigError::Value { .. })), "{query}");
    }
}

proptest! {
    #[test]
    fn arbitrary_value_never_panics(key in 0..25_usize, value in ".*") {
        let _ = Adapter::from_pairs(&[(all_setting_names(attachable_kinds())[key].to_owned(), value)], attachable_kinds());
    }
}
