//! The linestereo core on a PC: captured frames, synthetic scenes, evaluation, pictures.

pub mod board;
pub mod calibration;
pub mod commands;
pub mod compare;
pub mod directions;
pub mod draw;
pub mod engine;
pub mod evaluate;
pub mod export;
pub mod fitting;
pub mod frames;
pub mod health;
pub mod interchange;
pub mod listing;
pub mod monitor;
pub mod outline;
pub mod output;
pub mod planning;
pub mod rectify;
pub mod regions;
pub mod report;
pub mod scene;
