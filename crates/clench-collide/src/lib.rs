//! clench-collide
