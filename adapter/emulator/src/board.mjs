// What the board around the Pico connects to its pins. Pull-ups of the pins are not modelled by rp2040js.

const FAULT = 15, STRAPS = { serial: 18, supply: 19, analogue: 20 };

/** Connects the pins of a build with these parts: the digital build has none of them. */
export function connectBoard(pico, parts = Object.keys(STRAPS)) {
  pico.mcu.gpio[FAULT].setInputValue(true);
  for (const [part, pin] of Object.entries(STRAPS)) pico.mcu.gpio[pin].setInputValue(!parts.includes(part));
}
