//! Clock setup. The system runs at 120 MHz instead of the usual 125 MHz. Every clock period of SSI (12 MHz / n) and
//! BiSS (10 MHz / n) is then a whole number of cycles, without jitter.

use rp2040_hal as hal;

use hal::Clock as _;
use hal::clocks::{ClocksManager, InitError};
use hal::fugit::{HertzU32, RateExtU32 as _};
use hal::pac::{CLOCKS, PLL_SYS, PLL_USB, RESETS, XOSC};
use hal::pll::common_configs::PLL_USB_48MHZ;
use hal::pll::{PLLConfig, setup_pll_blocking};

/// Frequency of the system clock in hertz.
pub(crate) const SYSTEM_HZ: u32 = 120_000_000;
/// Frequency of the Pico's crystal in hertz.
pub(crate) const CRYSTAL_HZ: u32 = 12_000_000;

/// Configuration of the system PLL: 12 MHz × 120 / (6 × 2) = 120 MHz.
const SYSTEM: PLLConfig = PLLConfig { vco_freq: HertzU32::MHz(1440), refdiv: 1, post_div1: 6, post_div2: 2 };

/// Starts the crystal oscillator and both PLLs.
pub(crate) fn start(
    xosc: XOSC,
    clocks: CLOCKS,
    system: PLL_SYS,
    usb: PLL_USB,
    resets: &mut RESETS,
) -> Result<ClocksManager, InitError> {
    let crystal = hal::xosc::setup_xosc_blocking(xosc, CRYSTAL_HZ.Hz()).map_err(InitError::XoscErr)?;
    let mut manager = ClocksManager::new(clocks);
    let frequency = crystal.operating_frequency();
    let system = setup_pll_blocking(system, frequency, SYSTEM, &mut manager, resets).map_err(InitError::PllError)?;
    let usb = setup_pll_blocking(usb, frequency, PLL_USB_48MHZ, &mut manager, resets).map_err(InitError::PllError)?;
    manager.init_default(&crystal, &system, &usb).map_err(InitError::ClockError)?;
    debug_assert_eq!(manager.system_clock.freq().to_Hz(), SYSTEM_HZ);
    Ok(manager)
}
