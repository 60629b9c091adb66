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
//! On Genz's families, scipy's Sobol' points are as accurate as those of `mis` from as many
//! evaluations, over enough seeds: the gain over scipy is in speed. On the oscillatory integrand in 8
//! dimensions, where the 100 seeds of the table favour scipy, mean squared errors over 8000 and 16 000
//! other replicates of 2¹⁵ points are (1.36 ± 0.02) 10⁻¹⁰ and (1.38 ± 0.02) 10⁻¹⁰.
//!
//! Where `mis` gains little: on s1, the slides' example, the uniform technique beats sine and cosine: a
//! smooth integrand without peaks needs no importance sampling. The power heuristic is exact on gloss0,
//! whose disk covers the lobe: one technique is the integrand.
#![doc = include_str!("peers.md")]
#![doc = include_str!("scale.md")]
