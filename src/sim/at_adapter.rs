//! The virtual encoders that hang on the virtual adapter, a line each.

use crate::buses::bridge::sim::Attachable;
use crate::devices::biss::sim as biss;
use crate::devices::hiperface::sim as hiperface;
use crate::devices::ssi::sim as ssi;

/// Which encoders there are. The settings of the last one are named last.
pub const AT_ADAPTER: [&dyn Attachable; 3] = [&hiperface::AtAdapter, &ssi::AtAdapter::DELIVERED, &biss::AtAdapter];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buses::bridge::sim::{Adapter, keys};
    use crate::sim::ConfigError;
    use crate::sim::setting::pairs;
    use proptest::prelude::*;

    fn error(query: &str) -> Option<ConfigError> {
        Adapter::from_pairs(&pairs(query), &AT_ADAPTER).err()
    }

    #[test]
    fn each_reads_its_own_settings() {
        let query =
            "line=low&noise=0.5&ssi-error=error:2&ssi=ahm36,st=12&supply=switched&uart=hiperface&version=2&rpm=60";
        assert_eq!(error(query), None);
        let unknown = error("lin=low").unwrap().to_string();
        let sentence = "a virtual adapter has no setting `lin`; allowed are line, noise, ssi, ssi-error, supply, uart, \
                        version, seed, fault, firmware, ";
        assert!(unknown.starts_with(sentence), "{unknown}");
        for query in ["rpm=NaN", "noise=2", "ssi=x", "ssi-error=ERROR", "uart=on", "version=256", "seed=x"] {
            assert!(matches!(error(query), Some(ConfigError::Value { .. })), "{query}");
        }
    }

    proptest! {
        #[test]
        fn no_value_panics(key in 0..25_usize, value in ".*") {
            let _ = Adapter::from_pairs(&[(keys(&AT_ADAPTER)[key].to_owned(), value)], &AT_ADAPTER);
        }
    }
}
