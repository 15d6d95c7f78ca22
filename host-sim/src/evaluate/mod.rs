//! Scores against ground truth.
