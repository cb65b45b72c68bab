// An encoder with sine and cosine at the analogue inputs. Only arithmetic and time are modelled: a value is that of the
// moment at which its conversion begins.

/** Gain of the amplifier, and range of the converter in volts (docs/adapter.md). */
const GAIN = 2.2, RANGE = 3.3;

export class SineCosine {
  /** Amplitudes and offsets in volts between the wires of the encoder; `inputs` are volts at the other inputs, 2 to 4. */
  constructor(pico, { hz, sine = 0.5, cosine = 0.5, sineOffset = 0, cosineOffset = 0, inputs = [0, 0, 0] }) {
    const { adc } = pico.mcu;
    /** Time of each conversion in nanoseconds and its input, if they are recorded. */
    this.conversions = null;
    adc.onADCRead = (input) => {
      const now = pico.nanos, angle = 2 * Math.PI * hz * now * 1e-9;
      this.conversions?.push([now, input]);
      const volts = input === 0 ? sineOffset + sine * Math.sin(angle) : cosineOffset + cosine * Math.cos(angle);
      const level = input < 2 ? RANGE / 2 + GAIN * volts : inputs[input - 2];
      adc.currentChannel = input;
      adc.channelValues[input] = Math.max(0, Math.min(4095, Math.round(level / RANGE * 4096)));
      adc.sampleAlarm.schedule(adc.sampleTime * 1000);
    };
  }
}
