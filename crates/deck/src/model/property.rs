//! Materials, sections, amplitudes, contact pairs and their interactions.

use super::mesh::node_of;
use super::{
    Amplitude, Clearance, Ignored, Interaction, Law, Material, MaterialAxes, Model, Pair, RigidBody, Section, Tie,
    Touch,
};
use crate::error::{DeckError, Fault, Location, Word};
use crate::lexer::{Card, Named, name};
use signorini_fem_mesh::History;

/// The material that a card belongs to: the last one.
pub(super) fn of_material<'a>(model: &'a mut Model, card: &Card) -> Result<&'a mut Material, DeckError> {
    let last = model.materials.last_mut();
    last.ok_or_else(|| card.word.cannot("this belongs to a material; put *MATERIAL before it"))
}

/// The interaction that a card belongs to, likewise.
fn of_interaction<'a>(model: &'a mut Model, card: &Card) -> Result<&'a mut Interaction, DeckError> {
    let last = model.interactions.last_mut();
    last.ok_or_else(|| {
        card.word
            .cannot("this belongs to an interaction; put *SURFACE INTERACTION before it")
    })
}

pub(super) fn twice(card: &Card, first: &Location) -> DeckError {
    card.word.fault(Fault::Repeated {
        first: first.clone(),
        remedy: "keep one of them",
    })
}

pub(super) fn material(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME"])?;
    card.lines_at_most(0, "no data; *ELASTIC follows as a keyword of its own")?;
    let name = card.need("NAME")?.name;
    if let Some(at) = model.materials.position(&name) {
        return Err(twice(card, &model.materials.at(at).location));
    }
    let material = Material {
        location: card.word.location.clone(),
        elastic: None,
        density: None,
        expansion: None,
    };
    model.materials.add(name, material);
    Ok(())
}

pub(super) fn density(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&[])?;
    let material = of_material(model, card)?;
    let wanted = "one line with the density, a positive number";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(2, wanted)?;
    let value = line.real(&fields, 0, wanted)?;
    if value <= 0.0 {
        return Err(line.part(fields[0]).expected(wanted));
    }
    match material.density.replace(value) {
        Some(_) => Err(card.word.cannot("the material has a density already; keep one")),
        None => Ok(()),
    }
}

pub(super) fn section(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["ELSET", "MATERIAL", "ORIENTATION"])?;
    let [elset, material] = [card.need("ELSET")?, card.need("MATERIAL")?];
    let wanted = "nothing, or one number: solid elements have no thickness";
    card.lines_at_most(1, wanted)?;
    if let Some(line) = card.lines.first() {
        line.optional(&line.at_most(1, wanted)?, 0, wanted)?;
    }
    model.sections.push(Section {
        elset,
        material,
        axes: card
            .value("ORIENTATION")?
            .map_or(MaterialAxes::Global, MaterialAxes::Named),
    });
    Ok(())
}

pub(super) fn amplitude(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "TIME", "VALUE", "DEFINITION"])?;
    let amplitude = card.need("NAME")?.name;
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
        return Err(card.word.cannot(why));
    }
    let mut numbers = Vec::new();
    for line in &card.lines {
        let fields = line.fields();
        for at in 0..fields.len() {
            numbers.push(line.real(&fields, at, "pairs of time and value")?);
        }
    }
    if numbers.len() % 2 == 1 {
        return Err(card.word.expected("pairs of time and value; one value is missing"));
    }
    let points: Vec<(f64, f64)> = numbers.chunks_exact(2).map(|p| (p[0], p[1])).collect();
    let history = History::table(points.clone()).map_err(|e| card.word.fault(Fault::History(e)))?;
    let new = Amplitude { history, points, total };
    model.amplitudes.add(amplitude, new);
    Ok(())
}

pub(super) fn interaction(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME"])?;
    let name = card.need("NAME")?.name;
    let wanted = "nothing, or the thickness that plane models have";
    card.lines_at_most(1, wanted)?;
    if let Some(line) = card.lines.first() {
        line.optional(&line.at_most(1, wanted)?, 0, wanted)?;
        let why = "a thickness has a meaning in plane models only";
        model.ignored.push(Ignored::new(line, why));
    }
    if let Some(at) = model.interactions.position(&name) {
        return Err(twice(card, &model.interactions.at(at).location));
    }
    let interaction = Interaction {
        location: card.word.location.clone(),
        behavior: None,
        friction: None,
        tied: None,
        compliance: [0.0; 2],
    };
    model.interactions.add(name, interaction);
    Ok(())
}

pub(super) fn behavior(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["PRESSURE-OVERCLOSURE"])?;
    let interaction = of_interaction(model, card)?;
    let first = interaction.behavior.replace(card.word.location.clone());
    if let Some(first) = first {
        return Err(twice(card, &first));
    }
    let law = card.value("PRESSURE-OVERCLOSURE")?;
    match law.as_ref().map_or("HARD", |law| &law.name) {
        "LINEAR" => {}
        "HARD" => {
            card.lines_at_most(1, "at most a line that is not read: hard contact has no numbers")?;
            let why = "hard contact has no numbers";
            let ignored = card.lines.iter().map(|line| Ignored::new(line, why));
            model.ignored.extend(ignored);
            return Ok(());
        }
        "TIED" => {
            interaction.tied = law.map(|law| law.word);
            return card.lines_at_most(1, "one line with the slope of pressure over overclosure");
        }
        _ => {
            let why = "contact is hard, tied or has a linear law here; write PRESSURE-OVERCLOSURE=HARD without data lines, \
                or LINEAR with the slope";
            let word = law.as_ref().map_or(&card.word, |law| &law.word);
            return Err(word.fault(Fault::Unsupported(why)));
        }
    }
    let wanted = "one line with the slope of pressure over overclosure, a positive number";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(3, wanted)?;
    interaction.compliance[0] = inverse(line, &fields, 0, wanted)?;
    for at in [1, 2] {
        if line.optional(&fields, at, "a number")?.is_some() {
            let why = "pulling stress and reach of contact springs: there are none here where sides are apart";
            model.ignored.push(Ignored::new(&line.part(fields[at]), why));
        }
    }
    Ok(())
}

/// The inverse of a positive slope.
fn inverse(line: &Word, fields: &[&str], at: usize, wanted: &'static str) -> Result<f64, DeckError> {
    let slope = line.real(fields, at, wanted)?;
    if slope > 0.0 { Ok(slope.recip()) } else { Err(line.part(fields[at]).expected(wanted)) }
}

pub(super) fn friction(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["SLIP TOLERANCE", "ELASTIC SLIP"])?;
    let interaction = of_interaction(model, card)?;
    let wanted = "one line with the coefficient of friction, a number of at least zero";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(2, wanted)?;
    let value = line.real(&fields, 0, wanted)?;
    if value < 0.0 {
        return Err(line.part(fields[0]).expected(wanted));
    }
    if interaction.friction.replace(value).is_some() {
        let why = "the interaction has a coefficient already; keep one of them";
        return Err(card.word.cannot(why));
    }
    let slope = "the stick slope, a positive number, or 0 for none";
    let given = line.optional(&fields, 1, slope)?.is_some_and(|value| value != 0.0);
    if given {
        interaction.compliance[1] = inverse(line, &fields, 1, slope)?;
    }
    let why = "a number for penalty iterations only: the law is solved exactly here";
    let ignored = card.params.iter().map(|param| Ignored::new(&param.word, why));
    model.ignored.extend(ignored);
    if given {
        let why = "that Abaqus has slip rates in this column; it is the stick slope, as in CalculiX";
        model.ignored.push(Ignored::new(&line.part(fields[1]), why));
    }
    Ok(())
}

pub(super) fn pair(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["INTERACTION", "TYPE", "SMALL SLIDING", "ADJUST"])?;
    let interaction = card.need("INTERACTION")?;
    card.flag("SMALLSLIDING")?;
    let types = [
        "NODETOSURFACE",
        "SURFACETOSURFACE",
        "MORTAR",
        "LINMORTAR",
        "PGMORTAR",
        "PGLINMORTAR",
    ];
    let wanted = "NODE TO SURFACE, SURFACE TO SURFACE, MORTAR, LINMORTAR, PGMORTAR or PGLINMORTAR";
    card.choice("TYPE", &types, wanted)?;
    if let Some(kind) = card.param("TYPE") {
        let why = "matching meshes touch node by node, others by dual multipliers; there is one kind of contact here";
        model.ignored.push(Ignored::new(&kind.word, why));
    }
    let adjust = card.value("ADJUST")?.map(|named| {
        let reach = distance(&named, "a distance, not negative: nodes by sets are not adjusted");
        reach.map(|reach| (named.word, reach))
    });
    let adjust = adjust.transpose()?;
    pairs(model, card, &Law::Contact(Touch { interaction, adjust }))
}

/// The value of a parameter that is a distance.
fn distance(Named { name, word }: &Named, wanted: &'static str) -> Result<f64, DeckError> {
    let distance = word.part(name).real(&[name], 0, wanted).ok().filter(|d| *d >= 0.0);
    distance.ok_or_else(|| word.expected(wanted))
}

/// `*CLEARANCE`.
pub(super) fn clearance(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["SLAVE", "MASTER", "VALUE"])?;
    card.lines_at_most(0, "no data: VALUE is the gap of all nodes")?;
    let Named { name, word } = card.need("VALUE")?;
    let value = word.part(&name).real(&[&name], 0, "a number").ok();
    model.clearances.push(Clearance {
        word: card.word.clone(),
        slave: card.need("SLAVE")?,
        master: card.need("MASTER")?,
        value: value.ok_or_else(|| word.expected("a distance, negative for an interference"))?,
    });
    Ok(())
}

/// `*TIE`.
pub(super) fn tie(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "POSITION TOLERANCE", "ADJUST"])?;
    card.value("NAME")?;
    let adjust = card.choice("ADJUST", &["YES", "NO"], "YES or NO")?;
    let tolerance = card.value("POSITIONTOLERANCE")?;
    let tolerance = tolerance.map(|named| distance(&named, "a distance, not negative"));
    let tie = Tie {
        word: card.param("ADJUST").map_or(&card.word, |param| &param.word).clone(),
        adjust: adjust != Some(1),
        tolerance: tolerance.transpose()?,
    };
    pairs(model, card, &Law::Tied(tie))
}

/// The lines of pairs of surfaces: the dependent and the independent one.
pub(super) fn surfaces(card: &Card) -> Result<Vec<[Named; 2]>, DeckError> {
    let pair = |line: &Word| {
        let wanted = "the dependent (slave) and the independent (master) surface";
        let fields = line.at_most(2, wanted)?;
        let named = |text: &str| Named {
            name: name(text),
            word: line.part(text),
        };
        match fields[..] {
            [slave, master] if !slave.is_empty() && !master.is_empty() => Ok([named(slave), named(master)]),
            _ => Err(line.expected(wanted)),
        }
    };
    if card.lines.is_empty() {
        Err(card.word.cannot("the pair has no surfaces; name two in a line"))
    } else {
        card.lines.iter().map(pair).collect()
    }
}

fn pairs(model: &mut Model, card: &Card, law: &Law) -> Result<(), DeckError> {
    let pairs = surfaces(card)?.into_iter().map(|[slave, master]| Pair {
        law: law.clone(),
        slave,
        master,
    });
    model.pairs.extend(pairs);
    Ok(())
}

/// `*RIGID BODY`.
pub(super) fn rigid(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["ELSET", "NSET", "TIE NSET", "REF NODE", "ROT NODE", "PIN NSET"])?;
    card.lines_at_most(0, "no data")?;
    let elset = card.value("ELSET")?;
    let mut nset = None;
    for key in ["NSET", "PINNSET", "TIENSET"] {
        let Some(named) = card.value(key)? else { continue };
        if nset.is_some() {
            let why = "the body has nodes by NSET already; put all into one set, since both move in the same way here";
            return Err(named.word.cannot(why));
        }
        nset = Some(named);
    }
    if elset.is_none() && nset.is_none() {
        return Err(card.word.fault(Fault::MissingParameter("ELSET or NSET")));
    }
    model.rigid.push(RigidBody {
        word: card.word.clone(),
        elset,
        nset,
        reference: node_of(card.need("REFNODE")?),
        rotation: card.value("ROTNODE")?.map(node_of),
    });
    Ok(())
}

/// What a step does to a contact pair.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// Whether it comes, or goes.
    pub(crate) add: bool,
    pub(crate) slave: Named,
    pub(crate) master: Named,
}

/// `*MODEL CHANGE` of contact pairs.
pub(super) fn changes(card: &Card) -> Result<Vec<Change>, DeckError> {
    let of_pairs = card.value("TYPE")?.filter(|named| named.name == "CONTACTPAIR");
    if of_pairs.is_none() {
        let why = "bodies are there at all steps; contact pairs come and go with TYPE=CONTACT PAIR, and supports with \
            *BOUNDARY, OP=NEW";
        return Err(card.word.fault(Fault::Unsupported(why)));
    }
    card.allow(&["TYPE", "ADD", "REMOVE"])?;
    let add = match (card.flag("ADD")?, card.flag("REMOVE")?) {
        (add, remove) if add == remove => return Err(card.word.expected("ADD or REMOVE")),
        (add, _) => add,
    };
    let change = |[slave, master]: [Named; 2]| Change { add, slave, master };
    Ok(surfaces(card)?.into_iter().map(change).collect())
}
