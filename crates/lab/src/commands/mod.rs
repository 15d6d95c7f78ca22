//! One thin file per command: a `pub struct Args` and a `pub fn run(args: &Args) ->
//! anyhow::Result<()>`.

mod batch;
pub mod compare;
pub mod faults;
pub mod fit_confidence;
pub mod thin;
