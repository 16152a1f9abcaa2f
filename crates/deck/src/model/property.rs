//! Materials, sections, amplitudes, contact pairs and their interactions.

use super::{Amplitude, Ignored, Interaction, Material, Model, Pair, RigidBody, Section, Target};
use crate::error::{DeckError, Fault};
use crate::lexer::{Card, Line, Param, label, name};
use signorini_fem_mesh::History;

pub(super) const PENALTY: &str = "a number for penalty iterations only: the law is solved exactly here";

fn word(param: Option<&Param>) -> String {
    param.map(|p| p.word.clone()).unwrap_or_default()
}

/// The material or interaction that a card belongs to: the last one.
pub(super) fn inside<'a, T>(last: Option<&'a mut T>, card: &Card, what: &'static str) -> Result<&'a mut T, DeckError> {
    last.ok_or_else(|| card.fault(Fault::Misplaced(what)))
}

pub(super) fn twice(card: &Card, first: usize) -> DeckError {
    let remedy = "keep one of them";
    card.fault(Fault::Repeated { first, remedy })
}

pub(super) fn material(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME"])?;
    card.lines_at_most(0, "no data; *ELASTIC follows as a keyword of its own")?;
    let name = card.need("NAME")?;
    if let Some(at) = model.materials.position(&name) {
        return Err(twice(card, model.materials.at(at).location.line));
    }
    let material = Material {
        location: card.location.clone(),
        elastic: None,
        density: None,
    };
    model.materials.add(name, material);
    Ok(())
}

pub(super) fn density(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&[])?;
    let material = inside(
        model.materials.last_mut(),
        card,
        "*DENSITY belongs to a material; put *MATERIAL before it",
    )?;
    let wanted = "one line with the density, a positive number";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(2, wanted)?;
    let value = line.real(&fields, 0, wanted)?;
    if value <= 0.0 || material.density.is_some() {
        return Err(line.fault(fields[0], Fault::Expected(wanted)));
    }
    material.density = Some(value);
    Ok(())
}

pub(super) fn section(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["ELSET", "MATERIAL"])?;
    let [elset, material] = [card.need("ELSET")?, card.need("MATERIAL")?];
    let wanted = "nothing, or one number: solid elements have no thickness";
    card.lines_at_most(1, wanted)?;
    if let Some(line) = card.lines.first() {
        line.optional(&line.at_most(1, wanted)?, 0, wanted)?;
    }
    model.sections.push(Section {
        location: card.location.clone(),
        elset: (elset, word(card.param("ELSET"))),
        material: (material, word(card.param("MATERIAL"))),
    });
    Ok(())
}

pub(super) fn amplitude(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "TIME", "VALUE", "DEFINITION"])?;
    let amplitude = card.need("NAME")?;
    card.choice("VALUE", &["RELATIVE"], "VALUE=RELATIVE; other values are not supported")?;
    card.choice(
        "DEFINITION",
        &["TABULAR"],
        "DEFINITION=TABULAR; others are not supported",
    )?;
    let times = ["STEPTIME", "TOTALTIME"];
    let total = card.choice("TIME", &times, "TIME=STEP TIME or TIME=TOTAL TIME")? == Some(1);
    if model.amplitudes.position(&amplitude).is_some() {
        let why = "an amplitude of this name is there already; give all its points at once";
        return Err(card.fault(Fault::Misplaced(why)));
    }
    let mut numbers = Vec::new();
    for line in &card.lines {
        let fields = line.fields();
        for at in 0..fields.len() {
            numbers.push(line.real(&fields, at, "pairs of time and value")?);
        }
    }
    if numbers.len() % 2 == 1 {
        return Err(card.fault(Fault::Expected("pairs of time and value; one value is missing")));
    }
    let points: Vec<(f64, f64)> = numbers.chunks_exact(2).map(|p| (p[0], p[1])).collect();
    let history = History::table(points.clone()).map_err(|e| card.fault(Fault::History(e)))?;
    let new = Amplitude { history, points, total };
    model.amplitudes.add(amplitude, new);
    Ok(())
}

pub(super) fn interaction(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME"])?;
    let name = card.need("NAME")?;
    let wanted = "nothing, or the thickness that plane models have";
    card.lines_at_most(1, wanted)?;
    if let Some(line) = card.lines.first() {
        line.optional(&line.at_most(1, wanted)?, 0, wanted)?;
        model.ignored.push(Ignored::new(
            &line.location,
            line.text.trim(),
            "a thickness has a meaning in plane models only",
        ));
    }
    if let Some(at) = model.interactions.position(&name) {
        return Err(twice(card, model.interactions.at(at).location.line));
    }
    let interaction = Interaction {
        location: card.location.clone(),
        friction: None,
        compliance: [0.0; 2],
    };
    model.interactions.add(name, interaction);
    Ok(())
}

pub(super) fn behavior(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["PRESSURE-OVERCLOSURE"])?;
    let interaction = inside(
        model.interactions.last_mut(),
        card,
        "*SURFACE BEHAVIOR belongs to an interaction; put *SURFACE INTERACTION before it",
    )?;
    let law = card.value("PRESSURE-OVERCLOSURE")?;
    if let (Some(law), Some(param)) = (&law, card.param("PRESSURE-OVERCLOSURE"))
        && !["HARD", "LINEAR"].contains(&law.as_str())
    {
        let why = "contact is hard or has a linear law here; write PRESSURE-OVERCLOSURE=HARD without data lines, or \
        LINEAR with the slope (tied surfaces: *TIE)";
        return Err(card.param_fault(param, Fault::Unsupported(why)));
    }
    if law.is_none_or(|law| law == "HARD") {
        return card.lines_at_most(0, "no data: hard contact has no numbers");
    }
    let wanted = "one line with the slope of pressure over overclosure, a positive number";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(3, wanted)?;
    interaction.compliance[0] = inverse(line, &fields, 0, wanted)?;
    for at in [1, 2] {
        if line.optional(&fields, at, "a number")?.is_some() {
            model.ignored.push(Ignored::new(
                &line.location,
                fields[at],
                "pulling stress and reach of contact springs: there are none here where sides are apart",
            ));
        }
    }
    Ok(())
}

/// The inverse of a positive slope.
fn inverse(line: &Line, fields: &[&str], at: usize, wanted: &'static str) -> Result<f64, DeckError> {
    let slope = line.real(fields, at, wanted)?;
    match slope > 0.0 {
        true => Ok(slope.recip()),
        false => Err(line.fault(fields[at], Fault::Expected(wanted))),
    }
}

pub(super) fn friction(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    const PENALTIES: [&str; 2] = ["SLIP TOLERANCE", "ELASTIC SLIP"];
    card.allow(&PENALTIES)?;
    let interaction = inside(
        model.interactions.last_mut(),
        card,
        "*FRICTION belongs to an interaction; put *SURFACE INTERACTION before it",
    )?;
    let wanted = "one line with the coefficient of friction, a number of at least zero";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(2, wanted)?;
    let value = line.real(&fields, 0, wanted)?;
    if value < 0.0 {
        return Err(line.fault(fields[0], Fault::Expected(wanted)));
    }
    if interaction.friction.replace(value).is_some() {
        let why = "the interaction has a coefficient already; keep one of them";
        return Err(card.fault(Fault::Misplaced(why)));
    }
    let slope = "the stick slope, a positive number";
    if line.optional(&fields, 1, slope)?.is_some() {
        interaction.compliance[1] = inverse(line, &fields, 1, slope)?;
    }
    let ignored = card
        .params
        .iter()
        .map(|param| Ignored::new(&card.location, &param.word, PENALTY));
    model.ignored.extend(ignored);
    Ok(())
}

pub(super) fn pair(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["INTERACTION", "TYPE", "SMALL SLIDING"])?;
    card.need("INTERACTION")?;
    card.flag("SMALLSLIDING")?;
    let Some(interaction) = card.param("INTERACTION") else {
        return Ok(());
    };
    let types = [
        "NODETOSURFACE",
        "SURFACETOSURFACE",
        "MORTAR",
        "LINMORTAR",
        "PGLINMORTAR",
    ];
    let wanted = "NODE TO SURFACE, SURFACE TO SURFACE, MORTAR, LINMORTAR or PGLINMORTAR";
    if card.choice("TYPE", &types, wanted)?.is_some() {
        model.ignored.push(Ignored::new(
            &card.location,
            &word(card.param("TYPE")),
            "matching meshes touch node by node, others by dual multipliers; there is one kind of contact here",
        ));
    }
    surfaces(model, card, Some(interaction))
}

/// `*TIE`.
pub(super) fn tie(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "POSITION TOLERANCE", "ADJUST"])?;
    card.value("NAME")?;
    if let (Some(0), Some(param)) = (
        card.choice("ADJUST", &["YES", "NO"], "YES or NO")?,
        card.param("ADJUST"),
    ) {
        let why = "nodes are not moved: a distance between tied surfaces stays as it is; write ADJUST=NO";
        return Err(card.param_fault(param, Fault::Cannot(why.to_owned())));
    }
    if card.value("POSITIONTOLERANCE")?.is_some() {
        model.ignored.push(Ignored::new(
            &card.location,
            &word(card.param("POSITIONTOLERANCE")),
            "what faces the other surface is tied, at any distance; tie surfaces that lie on one another",
        ));
    }
    surfaces(model, card, None)
}

/// The lines of pairs of surfaces.
fn surfaces(model: &mut Model, card: &Card, interaction: Option<&Param>) -> Result<(), DeckError> {
    for line in &card.lines {
        let wanted = "the dependent (slave) and the independent (master) surface";
        let fields = line.at_most(2, wanted)?;
        match fields[..] {
            [slave, master] if !slave.is_empty() && !master.is_empty() => model.pairs.push(Pair {
                location: line.location.clone(),
                interaction: interaction.cloned(),
                slave: slave.to_owned(),
                master: master.to_owned(),
            }),
            _ => return Err(line.fault(line.text.trim(), Fault::Expected(wanted))),
        }
    }
    if card.lines.is_empty() {
        return Err(card.fault(Fault::Empty("the pair has no surfaces; name two in a line")));
    }
    Ok(())
}

/// `*RIGID BODY`.
pub(super) fn rigid(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["ELSET", "REF NODE", "ROT NODE"])?;
    card.lines_at_most(0, "no data")?;
    let elset = card.need("ELSET")?;
    card.need("REFNODE")?;
    let node = |key: &str| {
        let text = card.value(key)?;
        let target = text.map(|text| match label(&text) {
            Some(number) => Target::Number(number),
            None => Target::Name(text),
        });
        Ok::<_, DeckError>(target.map(|target| (target, word(card.param(key)))))
    };
    let Some(reference) = node("REFNODE")? else {
        return Ok(());
    };
    model.rigid.push(RigidBody {
        location: card.location.clone(),
        elset: (elset, word(card.param("ELSET"))),
        reference,
        rotation: node("ROTNODE")?,
    });
    Ok(())
}

/// The interaction of a pair, as names are compared.
pub(crate) fn named(param: &Param) -> String {
    name(param.value.as_deref().unwrap_or(""))
}
