//! Obstacles of every pair to an autopilot, as MAVLink on a port of its own, and to the host.
//!
//! In: the view of the rig, and of every pair its matches and health; bytes of the autopilot. Out:
//! frames on a port, paced by [`AutopilotStream`]; requests that are answered ([`Received`]).
//!
//! # Cost
//! 0.6 KB; instructions in `xtask/board-numbers.toml`.

use crate::ports::{ByteSink, packets};
use crate::vehicle::Vehicle;
use linestereo::Matched;
use linestereo::obstacles::{ObstaclePlan, Obstacles};
use linestereo_mavlink::{
    AutopilotParams, AutopilotStream, Mavlink, ParamValue, Received, Receiver, Sender,
};
use linestereo_wire::{SETTINGS, SendError, Setting, SettingValues, send_sectors};

/// Obstacles by direction, and their stream to an autopilot. Silent until there is a rig.
#[derive(Clone, Debug)]
pub struct Autopilot {
    vehicle: Vehicle,
    obstacles: Obstacles,
    view: Option<(ObstaclePlan, AutopilotStream)>,
    receiver: Receiver,
    /// Of answers while there is no view.
    sender: Sender,
    /// The next of the parameters that are to be listed.
    pub listed: Option<u8>,
}

impl Autopilot {
    /// Nothing seen, no rig.
    pub const fn new(vehicle: Vehicle) -> Self {
        let sender = Sender {
            system: vehicle.system,
            component: AutopilotParams::DEFAULT.component,
            sequence: 0,
        };
        Self {
            vehicle,
            obstacles: Obstacles::new(),
            view: None,
            receiver: Receiver::new(),
            sender,
            listed: None,
        }
    }

    /// Another vehicle from now on: what is known of obstacles is forgotten.
    pub fn set_vehicle(&mut self, vehicle: Vehicle) {
        if vehicle != self.vehicle {
            (self.vehicle, self.view, self.sender.system) = (vehicle, None, vehicle.system);
        }
    }

    /// Takes a byte of the autopilot.
    pub fn receive(&mut self, byte: u8) -> Option<Received> {
        let Sender { system, component, .. } = self.sender;
        self.receiver.push(byte, system, component)
    }

    /// Answers the autopilot.
    pub fn send(&mut self, message: &impl Mavlink, port: &mut impl ByteSink) {
        let Ok(()) = match &mut self.view {
            Some((_, stream)) => stream.send(message, &mut packets(port)),
            None => self.sender.send(message, &mut packets(port)),
        };
    }

    /// Answers with a parameter: a setting as it is. `false` when there is none of this number.
    pub fn send_parameter(
        &mut self,
        values: &SettingValues,
        number: u8,
        port: &mut impl ByteSink,
    ) -> bool {
        let (Some(setting), Some(&value)) = (Setting::get(number), values.get(usize::from(number)))
        else {
            return false;
        };
        let mut id = [0; 16];
        for (place, byte) in id.iter_mut().zip(setting.name.bytes()) {
            *place = byte.to_ascii_uppercase();
        }
        self.send(&ParamValue { id, value, index: number.into(), count: SETTINGS as u16 }, port);
        true
    }

    /// Pairs are seen so from now on; if it is another view than before, nothing is known any more.
    pub fn set_view(&mut self, plan: Option<ObstaclePlan>) {
        if plan == self.view.as_ref().map(|(plan, _)| *plan) {
            return;
        }
        self.obstacles = Obstacles::new();
        self.view = plan.and_then(|plan| {
            Some((plan, AutopilotStream::new(self.vehicle.autopilot(&plan), &plan).ok()?))
        });
    }

    /// Is it known how pairs are seen?
    pub fn has_view(&self) -> bool {
        self.view.is_some()
    }

    /// Takes the result of a pair.
    pub fn see(&mut self, matched: &Matched<'_>, time_us: u64) {
        match &self.view {
            Some((plan, _)) => matched.update_obstacles(plan, &mut self.obstacles, time_us),
            None => self.obstacles.mark_missing(),
        }
    }

    /// Sends a host what is known of each direction at the time that [`Autopilot::see`] got, after
    /// the frame of this number; nothing without a view, or where the vehicle's settings say so.
    pub fn send_sectors<E>(
        &self,
        sequence: u32,
        time_us: u64,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), SendError<E>> {
        match &self.view {
            Some((plan, _)) if self.vehicle.sectors => {
                send_sectors(sequence, plan, &self.obstacles, time_us, write)
            }
            _ => Ok(()),
        }
    }

    /// There was no pair, or it could not be matched.
    pub fn miss(&mut self) {
        self.obstacles.mark_missing();
    }

    /// Writes what is due.
    pub fn turn(&mut self, time_us: u64, port: &mut impl ByteSink) {
        if let Some((plan, stream)) = &mut self.view {
            let Ok(()) = stream.turn(&self.obstacles, plan, time_us, &mut packets(port));
        }
    }
}
