//! [`umbrage::Shadows`] on a real device, judged by rays. One program: linking is most of what tests of a GPU cost.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/crowd.rs"]
mod crowd;

mod maps;
mod masks;
mod misuse;
mod moving;
mod own;
mod screen;
mod steady;
mod stress;
