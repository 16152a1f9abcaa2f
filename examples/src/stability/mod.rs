//! Hard cases: what makes a scene hard, what the library does with it, and what has to hold afterwards.
//!
//! | module | holds |
//! |---|---|
//! | [`case`](mod@case) | a case: what is hard, how it is built, what is acceptable |
//! | [`runner`] | runs a case: never panics, measures certificate, balances, products, time |
//! | [`balance`] | forces, moments and energy, computed apart from the solver |
//! | [`block`] | the body of most cases: the benchmark's brick with everything variable |
//! | `cases_*` | the cases, one group a file |
//! | [`locking`] | linear tetrahedra near incompressibility, measured |
//! | [`report`] | the table, and the document `docs/reports/stability.md` |

pub mod app;
pub mod balance;
pub mod block;
pub mod case;
pub mod cases_bodies;
pub mod cases_contact;
pub mod cases_material;
pub mod cases_partners;
pub mod cases_restart;
pub mod cases_shape;
pub mod cases_sliding;
pub mod cases_time;
pub mod locking;
pub mod report;
pub mod runner;

/// All cases, in the order of the document.
#[must_use]
pub fn cases() -> Vec<case::Case> {
    let mut all = cases_contact::friction();
    all.extend(cases_contact::sets());
    all.extend(cases_contact::sliding());
    all.extend(cases_sliding::cases());
    all.extend(cases_bodies::free());
    all.extend(cases_bodies::supports());
    all.extend(cases_partners::cases());
    all.extend(cases_material::cases());
    all.extend(cases_shape::cases());
    all.extend(cases_time::cases());
    all.extend(cases_restart::cases());
    all
}
