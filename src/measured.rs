//! What was measured: `mis` beside other integrators, and how its time and memory grow.
//!
//! This page is documentation only. [`run`](crate::run) has the coverage of its intervals.
//!
//! # Beside other integrators
//!
//! `benches/peers/run --write` installs the others and runs them all on the same integrands, with
//! exact references; `benches/peers/README.md` tells how, and how to read the tables. Genz's families
//! (oscil, prodpk, gauss, c0) are smooth or nearly so and have one peak: Sobol' points alone carry them,
//! and no technique but the uniform one is used. lepage4 and camel5 have two peaks in four and five
//! dimensions, gloss0 to gloss4 are a lobe over a disk that is ever smaller: there, it is the
//! techniques.
//!
//! Where `mis` gains little: on the oscillatory integrand in 8 dimensions, 1.6 times scipy; it is three
//! times as fast there, and was as accurate over 300 other seeds. And on s1, the slides' example, where
//! the uniform technique beats sine and cosine: a smooth integrand without peaks needs no importance
//! sampling. The power heuristic is exact on gloss0, whose disk covers the lobe: one technique is the
//! integrand.
#![doc = include_str!("peers.md")]
#![doc = include_str!("scale.md")]
