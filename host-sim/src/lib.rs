//! The linestereo core on a PC: captured frames, synthetic scenes, evaluation, pictures.

pub mod engine;
