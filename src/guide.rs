//! A guide: how to choose techniques, weights and estimator, how to read a report, and when not to
//! trust it.
//!
//! Figures are exact by quadrature unless a number of seeds is given with them; the tests compare them
//! with what the estimators do. N V is the variance of an estimate from N samples, times N.
//!
//! # In one line
//!
//! [`integrate`](crate::integrate) draws a pilot, predicts what every method would come to, and runs
//! the best. What follows is how to have it succeed, and how to do without.
//!
//! # Techniques
//!
//! **Give every peak and every factor a density of its own, and let their union cover f.** A narrow
//! peak that no technique knows is not found, and no judgement can see that: of
//! x and a spike of width 10⁻³ that holds half of the variance, one run of 1000 samples in three has no
//! sample on the spike and reports an error that is far too small ([`run`](crate::run), *x and a
//! hidden spike*).
//!
//! **A density may be too wide, not too narrow.** f²/p must have a finite integral over the tail. For
//! a normal f and one normal technique of twice its width, N V = 0.51; of half its width, it is
//! infinite. Beside each other under balance weights they come to 0.10 for one sample of each: the
//! wide one covers the other's tail.
//!
//! **A density that is only a factor of f can be worse than none.** For sin x cos x on \[0, π/2\], cos
//! alone has N V = 0.083, sin as well, the uniform density 0.058. Both together, balanced, have 0.040;
//! but their samples take an arc sine and more, and for the same time the uniform density wins.
//! A smooth integrand without peaks does not need importance sampling. A [`Plan`](crate::Plan) measures
//! both sides of that.
//!
//! **Smooth densities, by their inverse CDF**, make the most of [`Sobol`](crate::points::Sobol)
//! points: the error of sin x cos x falls as n^-1.37 with them, not as n^-0.5 (balance weights, n from 2⁸
//! to 2¹⁷; `tests/coverage`). Cutoff and maximum weights jump, which costs part of the gain.
//!
//! **A defensive technique is cheap insurance**: one that covers all of f, with a tenth of the
//! samples, keeps every contribution below ten times what it alone would give.
//!
//! **A technique of your own**: run [`check`](crate::check) on it once. A sampler and a pdf that do not
//! agree are the commonest bug of this field, and bias silently.
//!
//! # Weights
//!
//! | weights | sin x cos x | A | E | x^-1/2 | why |
//! |---|--:|--:|--:|--:|---|
//! | best technique alone, N V | 0.0833 | 3.99 | 4.10 | 0 | |
//! | constant, equal | 0.0417 | 2.07 | ∞ | ∞ | the bad technique's variance counts in full |
//! | [`Balance`](crate::weighting::Balance) | 0.0199 | 0.139 | 93.4 | 0.178 | never far from the best heuristic |
//! | [`Power`](crate::weighting::Power) 2 | 0.0274 | 0.276 | 616 | 0.294 | |
//! | [`Maximum`](crate::weighting::Maximum) | 0.1107 | 1.14 | 5176 | 1.386 | |
//! | [`OptimalMis`](crate::OptimalMis) | 0.0199 | 0.031 | 0 | 0 | nothing is better |
//!
//! Variances for one sample of each technique. A is √x + sin x with densities ∝ 2 - x and sin² x; E is
//! 30 x + (x² - x/π) + sin x with densities ∝ its three terms; x^-1/2 has the densities 1 and
//! 1 / (2 √x).
//!
//! - **Balance** is the default. For f ≥ 0 no other non-negative weights are better by more than
//!   (1 / min n_i - 1 / N) μ².
//! - **Power** helps where one technique is nearly exact in some region, as for small lights on glossy
//!   surfaces: for the largest of Veach's lights on his shiniest plate, the relative variance is 0.00063
//!   against 0.0036. It hurts elsewhere, as the table has it.
//! - **Optimal MIS** takes K² operations more for each sample where its coefficients are fitted, K where they are
//!   known. It is worth that where techniques are good in parts (E above: balance is 23 times worse
//!   than the best technique alone). It is no use where weights are not what loses: sin x cos x.
//! - **Constant** weights evaluate one pdf a sample instead of K. Every technique must cover f: with f = 1 on
//!   \[0, 2\] and uniform densities on either half, they give 1, not 2, and nothing in the samples
//!   tells. Weights must not come from the same samples: of 10 on \[0, 0.1\], with inverse sample variances
//!   from 32 samples of a uniform and a linear density, the mean is 0.29, not 1.
//!
//! # Numbers of samples
//!
//! Equal numbers are right when nothing is known: the second moment is then at most K times the least
//! that balance weights can have. That may be much. With the best shares, N V of A falls from 0.369 to
//! 0.091 (one-sample), of E from 350 to 0, as its integrand is a mixture of the densities. [`Pilot::allocate`](crate::plan::Pilot::allocate) finds the shares from one pilot,
//! with the costs of the techniques; [`Adaptive`](crate::plan::Adaptive) finds them on the way. No
//! technique is left without samples, as one that alone covers a region must have some, and what it
//! would show could not be known.
//!
//! # Which estimator
//!
//! | you have | take |
//! |---|---|
//! | no idea | [`integrate`](crate::integrate) |
//! | an integrand that takes a millisecond and more | [`OptimalMis`](crate::OptimalMis), or [`Adaptive`](crate::plan::Adaptive): every sample counts |
//! | a smooth integrand, up to some ten dimensions that matter | any multi-sample estimator with [`Sobol`](crate::points::Sobol) points |
//! | millions of cheap integrals, one a pixel | [`MultiSample`](crate::MultiSample) with given counts: a plan or a run costs more than the samples |
//! | one sample at a time | [`OneSample`](crate::OneSample) |
//! | functions with known integrals that resemble f | [`OptimalMis::control_variates`](crate::OptimalMis::control_variates) |
//! | expensive pdfs that each cover f | constant weights |
//!
//! Points: random numbers for runs whose error has to be judged from few samples, and for integrands
//! with jumps in many dimensions. [`Sobol`](crate::points::Sobol) otherwise.
//! [`Antithetic`](crate::points::Antithetic) pairs only for integrands that are nearly linear in ξ, for symmetric
//! ones they double the variance; [`Stratified`](crate::points::Stratified) where additive
//! parts dominate.
//!
//! # Reading a report
//!
//! `println!("{report}")`, from the top:
//!
//! 1. **The status.** *Converged* and *budget spent* mean that nothing in the samples speaks against the
//!    error; measured over 10⁴ seeds, 95 % intervals of such runs then hold in 94 to 96 % of them
//!    ([`run`](crate::run) has the table). *Suspect* names its reasons.
//! 2. **Rounds against each other**: a probability below 0.001 says that rounds differ by more than their
//!    errors; then something is wrong with the integrand or the errors.
//! 3. **Techniques**: one that has most of the variance and little of the value needs more samples, or a
//!    better density; one with hardly a share of either is not needed. **p agrees, z**: beyond 4.42, some
//!    sampler does not draw from the pdf that it states.
//! 4. **κ**: below 0.07, an interval of 95 % holds in 94 to 96 %; above 0.1, it misses on one side.
//!    **k̂**: from 1/2 on, the variance may be infinite; above 0.7, no error can be believed. **The largest
//!    contribution**: more than a per cent of the value in one sample is too much.
//!
//! # When not to trust it
//!
//! - If no technique reaches a region where f is not 0. The estimate is what is left, and the error
//!   that of it. Add a wide technique, and see whether the value moves.
//! - If f has a peak that is narrower than 1 / n of all samples. Look at the largest contribution, and
//!   run again with another seed and ten times the samples: the values must agree.
//! - If constant weights or a single technique are used and a density does not cover f.
//! - If a point is judged by the error of 16 replicates alone: t with 15 degrees of freedom is honest for
//!   values that are nearly normal, and few replicates cannot show that they are not.
//! - If the number of samples was chosen by looking at the error, otherwise than through a
//!   [`Target`](crate::Target): of runs that look for a probability of 0.1, and end at the first error
//!   below 0.02 from the tenth sample on, 61 % of the 95 % intervals hold it (2000 seeds).
//! - If [`Prediction`](crate::plan::Prediction)s carry a caution. A pilot of a few thousand samples knows
//!   nothing of what happens once in ten thousand.
