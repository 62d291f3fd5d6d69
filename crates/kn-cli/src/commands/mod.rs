//! One file per command.

mod assemble;
mod compare;
mod conform;
mod decode;
mod demo;
mod dump;
mod encode;
mod info;
mod rd;
mod register;
mod segment;
mod verify;

use crate::Outcome;
use crate::arguments::Global;

/// The command to run.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Command {
    Encode(encode::EncodeArguments),
    Decode(decode::DecodeArguments),
    Info(info::InfoArguments),
    Dump(dump::DumpArguments),
    Verify(verify::VerifyArguments),
    Compare(compare::CompareArguments),
    Rd(rd::RdArguments),
    Register(register::RegisterArguments),
    Segment(segment::SegmentArguments),
    Demo(demo::DemoArguments),
    Conform(conform::ConformArguments),
    Assemble(assemble::AssembleArguments),
}

/// Runs a command.
pub(crate) fn run(command: &Command, global: &Global) -> anyhow::Result<Outcome> {
    match command {
        Command::Encode(arguments) => encode::run(arguments, global),
        Command::Decode(arguments) => decode::run(arguments, global),
        Command::Info(arguments) => info::run(arguments),
        Command::Dump(arguments) => dump::run(arguments),
        Command::Verify(arguments) => verify::run(arguments, global),
        Command::Compare(arguments) => compare::run(arguments, global),
        Command::Rd(arguments) => rd::run(arguments, global),
        Command::Register(arguments) => register::run(arguments, global),
        Command::Segment(arguments) => segment::run(arguments, global),
        Command::Demo(arguments) => demo::run(arguments, global),
        Command::Conform(arguments) => conform::run(arguments),
        Command::Assemble(arguments) => assemble::run(arguments),
    }
}
