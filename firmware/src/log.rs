//! Log lines by `defmt`, or none.

#[cfg(all(target_os = "none", feature = "log-rtt"))]
use defmt_rtt as _;
#[cfg(all(target_os = "none", feature = "log-semihosting"))]
use defmt_semihosting as _;

/// Logs a success.
#[macro_export]
macro_rules! info {
    ($text:literal $(, $value:expr)* $(,)?) => {{
        #[cfg(all(target_os = "none", any(feature = "log-semihosting", feature = "log-rtt")))]
        $crate::log::defmt::info!($text $(, $value)*);
        #[cfg(not(all(target_os = "none", any(feature = "log-semihosting", feature = "log-rtt"))))]
        { $(let _ = &$value;)* }
    }};
}

/// Logs a failure.
#[macro_export]
macro_rules! error {
    ($text:literal $(, $value:expr)* $(,)?) => {{
        #[cfg(all(target_os = "none", any(feature = "log-semihosting", feature = "log-rtt")))]
        $crate::log::defmt::error!($text $(, $value)*);
        #[cfg(not(all(target_os = "none", any(feature = "log-semihosting", feature = "log-rtt"))))]
        { $(let _ = &$value;)* }
    }};
}

#[cfg(all(target_os = "none", any(feature = "log-semihosting", feature = "log-rtt")))]
pub use defmt;
