//! Where scenarios and random sessions are played: what happens to a controller, told without saying
//! how the bytes come and when interrupts run, and the bench that turns it into lock-step events.

use super::body::{Body, SwitchBehaviour};
use super::coverage::Coverage;
use super::event::Event;
use super::reference::Reference;
use rsapien_firmware_model::{Inputs, MiddleSwitches};
use rsapien_protocol::{Address, BumperMask, Fed, LineError, Receiver, SynchronizationPackage};

/// Something that happens, besides time.
#[derive(Clone, Debug)]
pub enum Action {
    /// The line brings these bytes, one behind the other.
    Line(Vec<u8>),
    /// The line brings a byte that cannot be received.
    LineError(LineError),
    /// The bumpers pressed from now on.
    Bumpers(BumperMask),
    /// The mid-arm switches closed from now on; a body no longer drives them.
    Switches(MiddleSwitches),
    /// The supply is below 5 V from now on.
    Supply(bool),
    /// From now on a body drives the mid-arm switches.
    Body(Box<Body>),
    /// What the body's switches do from now on.
    SwitchBehaviour(SwitchBehaviour),
    /// One event, just so. Only in lock step.
    Event(Event),
}

/// Why a bench cannot go on: the two sides differ, or one is gone.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BenchError(pub String);

/// The reference model with what is around it.
#[derive(Clone, Debug)]
pub struct World {
    /// The reference model.
    pub reference: Reference,
    /// The pins as they are driven.
    pub inputs: Inputs,
    /// What drives the mid-arm switches.
    pub body: Option<Box<Body>>,
    /// How deep it went.
    pub coverage: Coverage,
    /// The last answer heard.
    pub answer: Option<SynchronizationPackage>,
    /// How many answers were heard since somebody looked last.
    pub answer_count: u32,
    /// The line bytes of the last answer heard.
    pub answer_bytes: Vec<u8>,
    heard: Receiver,
    package_bytes: Vec<u8>,
}

impl World {
    /// Around a controller as after power-on with boot number 0 in the EEPROM.
    pub fn new(address: Address) -> World {
        World {
            reference: Reference::new(address, 0),
            inputs: Inputs::default(),
            body: None,
            coverage: Coverage::new(address),
            answer: None,
            answer_count: 0,
            answer_bytes: Vec::new(),
            heard: Receiver::for_pc(),
            package_bytes: Vec::new(),
        }
    }

    /// Hears what the controller transmitted.
    pub fn hear(&mut self, transmitted: &[u8]) {
        for byte in transmitted {
            self.package_bytes.push(*byte);
            match self.heard.feed(*byte, 0) {
                Fed::Package(content) => {
                    self.answer = SynchronizationPackage::parse(&content).ok();
                    self.answer_bytes = std::mem::take(&mut self.package_bytes);
                    self.answer_count += 1;
                }
                _ if self.heard.state() == rsapien_protocol::ReceptionState::Hunting => {
                    self.package_bytes.clear();
                }
                _ => {}
            }
        }
    }

    /// The body goes on by one ms and drives the switches.
    pub fn move_body(&mut self) {
        if let Some(body) = &mut self.body {
            body.advance(self.reference.outputs());
            self.inputs.middle_switches = body.middle_switches();
        }
    }

    /// Takes a change of pins over. False for an action that is none.
    pub fn change_pins(&mut self, action: &Action) -> bool {
        match action {
            Action::Bumpers(bumpers) => self.inputs.bumpers = *bumpers,
            Action::Switches(switches) => {
                self.body = None;
                self.inputs.middle_switches = *switches;
            }
            Action::Supply(low) => self.inputs.supply_low = *low,
            Action::Body(body) => self.body = Some(body.clone()),
            Action::SwitchBehaviour(behaviour) => {
                if let Some(body) = &mut self.body {
                    body.switches = *behaviour;
                }
            }
            Action::Line(_) | Action::LineError(_) | Action::Event(_) => return false,
        }
        true
    }
}

/// A place where a controller is tried.
pub trait Bench {
    /// The reference model and what is around it.
    fn world(&mut self) -> &mut World;

    /// Lets `count` ms pass. `then` is what the line will have brought when they have passed, if that
    /// is known: where bytes take time, they come while it passes.
    ///
    /// # Errors
    /// When the two sides differ.
    fn ticks(&mut self, count: u32, then: Option<&[u8]>) -> Result<(), BenchError>;

    /// Lets something happen now.
    ///
    /// # Errors
    /// When the two sides differ.
    fn perform(&mut self, action: Action) -> Result<(), BenchError>;

    /// How many bytes the line takes from the controller in a ms, where that can be chosen.
    fn line_takes(&mut self, bytes_a_tick: u8);
}

/// The bench that writes down lock-step events, and the records that the model answers them with.
#[derive(Debug)]
pub struct LockstepBench {
    world: World,
    bytes_a_tick: u8,
    /// The events so far.
    pub events: Vec<Event>,
    /// The model's records of them.
    pub records: Vec<u8>,
}

/// Bytes that the line takes in a ms at 57600 bit/s.
pub const BYTES_A_TICK: u8 = 6;

impl LockstepBench {
    /// A bench with a controller as after power-on, with `eeprom_boot` in its EEPROM.
    pub fn new(address: Address, eeprom_boot: u8) -> LockstepBench {
        let world = World::new(address);
        let (events, records) = (Vec::new(), Vec::new());
        let mut bench = LockstepBench { world, bytes_a_tick: BYTES_A_TICK, events, records };
        bench.happen(Event::Anew(eeprom_boot));
        bench
    }

    /// Lets one event happen.
    pub fn happen(&mut self, event: Event) {
        let transmitted = self.world.reference.apply(event, &mut self.records);
        self.events.push(event);
        self.world.coverage.see(event, &self.world.reference, &transmitted);
        self.world.hear(&transmitted);
    }

    /// One ms: the body, the tick, and what the line takes.
    pub fn tick(&mut self) {
        self.world.move_body();
        self.happen(Event::Tick(self.world.inputs));
        if self.bytes_a_tick > 0 && self.world.reference.is_transmitting() {
            self.happen(Event::Transmit(self.bytes_a_tick));
        }
    }

    /// What was seen.
    pub fn coverage(&self) -> &Coverage {
        &self.world.coverage
    }
}

impl Bench for LockstepBench {
    fn world(&mut self) -> &mut World {
        &mut self.world
    }

    fn ticks(&mut self, count: u32, _then: Option<&[u8]>) -> Result<(), BenchError> {
        (0..count).for_each(|_| self.tick());
        Ok(())
    }

    fn perform(&mut self, action: Action) -> Result<(), BenchError> {
        match action {
            Action::Line(bytes) => {
                for byte in bytes {
                    self.happen(Event::Byte(byte));
                }
            }
            Action::LineError(error) => self.happen(Event::LineError(error)),
            // The pins are those of now: an event of a scenario does not bring its own.
            Action::Event(event) => self.happen(event.with_inputs(self.world.inputs)),
            pins => {
                self.world.change_pins(&pins);
            }
        }
        Ok(())
    }

    fn line_takes(&mut self, bytes_a_tick: u8) {
        self.bytes_a_tick = bytes_a_tick;
    }
}
