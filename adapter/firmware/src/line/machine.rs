//! A running PIO state machine with its FIFOs.

use pio::{Instruction, InstructionOperands, JmpCondition, MovDestination, MovOperation, MovSource, SetDestination};
use rp2040_hal as hal;

use hal::pio::{Running, Rx, StateMachine, Tx, ValidStateMachine};

pub(super) struct Machine<SM: ValidStateMachine> {
    machine: StateMachine<SM, Running>,
    rx: Rx<SM>,
    tx: Tx<SM>,
    /// Address of the program's first instruction.
    start: u8,
    /// Level of the output pin while the machine waits, or `None` if the machine has no output pin.
    idle: Option<u8>,
}

impl<SM: ValidStateMachine> Machine<SM> {
    pub(super) fn new(machine: StateMachine<SM, Running>, rx: Rx<SM>, tx: Tx<SM>, start: u8, idle: Option<u8>) -> Self {
        Machine { machine, rx, tx, start, idle }
    }

    /// Sets the number of system clock cycles per state machine cycle.
    pub(super) fn set_divisor(&mut self, divisor: u16) {
        self.machine.clock_divisor_fixed_point(divisor, 0);
    }

    /// Sets the number of system clock cycles per state machine cycle, in whole cycles and 256ths.
    pub(super) fn set_divisor_256(&mut self, whole: u16, fraction: u8) {
        self.machine.clock_divisor_fixed_point(whole, fraction);
    }

    /// Loads the output shift register (OSR). The machine must be waiting.
    pub(super) fn load_osr(&mut self, value: u32) {
        self.tx.write(value);
        self.execute(InstructionOperands::PULL { if_empty: false, block: false });
    }

    /// Loads the Y register through the OSR. The machine must be waiting.
    pub(super) fn load_y(&mut self, value: u32) {
        self.load_osr(value);
        self.execute(InstructionOperands::MOV {
            destination: MovDestination::Y,
            op: MovOperation::None,
            source: MovSource::OSR,
        });
    }

    pub(super) fn clear_x(&mut self) {
        self.execute(InstructionOperands::SET { destination: SetDestination::X, data: 0 });
    }

    /// Sets the Y register to a number below 32. Unlike [`load_y`](Self::load_y), this is possible while the machine
    /// waits for a word.
    pub(super) fn set_y(&mut self, data: u8) {
        self.execute(InstructionOperands::SET { destination: SetDestination::Y, data });
    }

    pub(super) fn clear_isr(&mut self) {
        self.execute(InstructionOperands::MOV {
            destination: MovDestination::ISR,
            op: MovOperation::None,
            source: MovSource::NULL,
        });
    }

    /// Sets the machine's output pins to high.
    pub(super) fn set_output_high(&mut self) {
        self.execute(InstructionOperands::MOV {
            destination: MovDestination::PINS,
            op: MovOperation::Invert,
            source: MovSource::NULL,
        });
    }

    /// Returns whether the machine is waiting at the beginning of its program.
    pub(super) fn is_at_start(&self) -> bool {
        self.machine.instruction_address() == u32::from(self.start)
    }

    /// Returns the address of the input FIFO, and the number of its DMA request signal.
    pub(super) fn input(&self) -> (*const u32, u8) {
        (self.tx.fifo_address(), self.tx.dreq_value())
    }

    /// Restarts the program from the beginning.
    pub(super) fn restart(&mut self) {
        self.execute(InstructionOperands::JMP { condition: JmpCondition::Always, address: self.start });
    }

    /// Adds a word to the input FIFO of the machine.
    pub(super) fn send(&mut self, word: u32) {
        self.tx.write(word);
    }

    /// Returns whether the machine has taken all words from its input FIFO.
    pub(super) fn has_consumed_all(&self) -> bool {
        self.tx.is_empty()
    }

    /// Waits for the next output word and returns it.
    pub(super) fn receive(&mut self) -> u32 {
        loop {
            if let Some(word) = self.rx.read() {
                return word;
            }
        }
    }

    /// Discards all words in the output FIFO.
    pub(super) fn discard(&mut self) {
        while self.rx.read().is_some() {}
    }

    /// Returns the address of the output FIFO, and the number of its DMA request signal.
    pub(super) fn output(&self) -> (*const u32, u8) {
        (self.rx.fifo_address(), self.rx.dreq_value())
    }

    fn execute(&mut self, operands: InstructionOperands) {
        self.machine.exec_instruction(Instruction { operands, delay: 0, side_set: self.idle });
    }
}
