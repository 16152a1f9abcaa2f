//! A recipe in the words of the library.

use crate::recipe::{
    Clock, Course, Density, Distance, Elastic, Ending, Fixed, Law, Pieces, Recipe, Solver, Touch, Where,
};
use crate::vec3::{Vec3, add, scale};
use signorini::prelude::*;

pub(crate) fn history(course: &Course) -> Result<History, Error> {
    Ok(match course {
        Course::Constant(value) => History::constant(*value),
        Course::Table(points) => History::table(points.clone())?,
        Course::Wave { size, pace, phase } => {
            let (size, pace, phase) = (*size, *pace, *phase);
            History::function(move |t| size * (pace * t + phase).sin())
        }
    })
}

fn load(density: &Density) -> Load {
    Load::new(match density.clone() {
        Density::Body(value) => LoadDensity::Body(value),
        Density::BodyField(field) => LoadDensity::body_field(move |x| field.map(|p| p.value(x))),
        Density::Traction(tag, value) => LoadDensity::Traction(tag, value),
        Density::TractionField(tag, field, pull) => LoadDensity::traction_field(tag, move |x, n: Vec3| {
            add(field.map(|p| p.value(x)), scale(pull.value(x), n))
        }),
        Density::Pressure(tag, value) => LoadDensity::Pressure(tag, value),
        Density::Nodes(forces) => LoadDensity::NodalForces(forces),
        Density::Force(tag, value) => LoadDensity::Force(tag, value),
        Density::Moment(tag, value) => LoadDensity::Moment(tag, value),
        Density::Eigenstrain(strain, region, factors) => {
            let strain = Eigenstrain::new(strain).with_factors(factors);
            return Load::eigenstrain(match region {
                Some(region) => strain.in_region(region),
                None => strain,
            });
        }
    })
}

pub(crate) fn friction(law: &Law) -> Friction {
    match law.clone() {
        Law::None => Friction::None,
        Law::Given(stress) => Friction::tresca(stress),
        Law::GivenField(field) => Friction::Tresca(SlipBound::field(move |x| field.value(x))),
        Law::Coulomb(value) => Friction::coulomb(value),
        Law::CoulombField(field) => Friction::Coulomb(Coefficient::field(move |x| field.value(x))),
        Law::Exponential { fixed, kinetic, decay } => {
            Friction::Coulomb(Coefficient::Exponential { fixed, kinetic, decay })
        }
        Law::Table(points) => Friction::Coulomb(Coefficient::Table(points)),
        Law::RateField(field, half) => Friction::Coulomb(Coefficient::rate_field(move |x, rate| {
            field.value(x) / (1.0 + rate / half)
        })),
    }
}

fn contact(touch: &Touch) -> Result<Contact, Error> {
    let tag = touch.tags[0];
    let mut contact = match (touch.partner, &touch.distance) {
        (Some(partner), _) => Contact::between(tag, partner),
        (None, Distance::Plane(point, outward)) => Contact::half_space(tag, *point, *outward),
        (None, _) => Contact::rigid(tag),
    };
    for tag in &touch.tags[1..] {
        contact = contact.with_tag(*tag);
    }
    contact = match &touch.distance {
        Distance::Touching if touch.partner.is_some() => contact.with_gap(0.0),
        Distance::Constant(gap) => contact.with_gap(*gap),
        Distance::Field(field) => {
            let field = *field;
            contact.with_gap_field(move |x| field.value(x))
        }
        Distance::Touching | Distance::Plane(..) | Distance::Measured => contact,
    };
    if let Some(direction) = touch.direction {
        contact = contact.with_normal(direction);
    }
    if let Some((way, course)) = &touch.motion {
        contact = contact.with_motion(*way, history(course)?);
    }
    Ok(contact.with_friction(friction(&touch.law)))
}

fn analysis(clock: &Clock) -> Result<Analysis, Error> {
    Ok(match clock {
        Clock::Static(time) => Analysis::Static { time: *time },
        Clock::Steps {
            times,
            weights: [a, b, c],
        } => Analysis::Quasistatic {
            times: times.clone(),
            formula: DifferenceFormula::new(*a, *b, *c)?,
        },
    })
}

/// The scene of a recipe.
pub(crate) fn scene(recipe: &Recipe) -> Result<Scene, Error> {
    let law = |elastic: &Elastic| match elastic {
        Elastic::Isotropic(young, poisson) => Hooke::isotropic(*young, *poisson),
        Elastic::Matrix(matrix) => Hooke::from_voigt(matrix),
    };
    let laws: Vec<Hooke> = recipe.elastic.iter().map(law).collect::<Result<_, _>>()?;
    let materials = match &laws[..] {
        [one] => Materials::uniform(*one),
        several => Materials::new((0..).zip(several.iter().copied()).collect())?,
    };
    let mut scene = Scene::new(recipe.mesh.clone(), materials).with_analysis(analysis(&recipe.clock)?);
    for hold in &recipe.holds {
        let place = match &hold.place {
            Where::Tag(tag) => Place::from(*tag),
            Where::Nodes(nodes) => Place::from(nodes.clone()),
        };
        let mut support = match &hold.fixed {
            Fixed::All => Support::fixed(place),
            Fixed::Components(on) => Support::components(place, *on),
            Fixed::Vectors(list) => Support::partial(place, Directions::Vectors(list.clone())),
            Fixed::About(point, axis, on) => Support::components(place, *on).with_axis(*point, *axis),
            Fixed::Each(lists) => Support::partial(place, Directions::EachNode(lists.clone())),
        };
        if let Some((values, course)) = &hold.motion {
            let history = history(course)?;
            support = match &values[..] {
                [one] => support.with_motion(*one, history),
                each => support.with_motions(each.to_vec(), history),
            };
        }
        scene = scene.with_support(support);
    }
    for push in &recipe.pushes {
        let load = load(&push.density).with_history(history(&push.course)?);
        scene = scene.with_load(load);
    }
    for touch in &recipe.touches {
        scene = scene.with_contact(contact(touch)?);
    }
    Ok(match &recipe.pieces {
        Pieces::Whole => scene,
        Pieces::Boxes(boxes) => scene.with_boxes(*boxes),
        Pieces::Parts(parts) => scene.with_parts_as_given(parts.clone()),
    })
}

/// The settings of a recipe.
pub(crate) fn settings(recipe: &Recipe) -> Settings {
    let how = &recipe.how;
    let mut settings = Settings::default()
        .with_extrapolation(how.extrapolate)
        .with_preconditioner(match how.preconditioner {
            0 => Preconditioner::Lumped,
            1 => Preconditioner::Dirichlet,
            _ => Preconditioner::None,
        });
    settings = match how.solver {
        Solver::Face => settings,
        Solver::Paper => settings.with_method(Method::paper()),
        Solver::OneLoop => settings.with_method(Method::one_loop()),
    };
    settings = match how.ending {
        Ending::Tolerance(tolerance) => settings.with_tolerance(tolerance),
        Ending::Relative(target) => settings.with_accuracy(Accuracy::Relative(target)),
        Ending::Balanced(fraction) => settings.with_accuracy(Accuracy::Balanced { fraction }),
    };
    if !how.share {
        settings = settings.with_share_translates(false);
    }
    if let Some((products, most)) = how.halving {
        let short = signorini::qp::ActiveSetSettings::default().with_max_products(products);
        settings = settings
            .with_method(Method::ActiveSet(short))
            .with_max_fallback_products(1)
            .with_step_halving(most);
    }
    settings
}
