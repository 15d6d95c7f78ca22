//! What the claims say of each other: neighbours that agree, neighbours that do not, rivals for the same place in the right image.
