//! Supports: where displacements are prescribed.

use super::span::Span;
use signorini_fem_mesh::{FacetTag, History, TetMesh};
use signorini_tfeti::Directions;

/// Where a support acts.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Place {
    /// All nodes of the facets with this tag.
    Tag(FacetTag),
    /// Single nodes, by their numbers in the mesh.
    Nodes(Vec<u32>),
}

impl Place {
    /// Its nodes in a mesh, as they are given.
    pub(crate) fn nodes(&self, mesh: &TetMesh) -> Vec<u32> {
        match self {
            Self::Tag(tag) => mesh.nodes_on(*tag),
            Self::Nodes(nodes) => nodes.clone(),
        }
    }
}

impl From<FacetTag> for Place {
    fn from(tag: FacetTag) -> Self {
        Self::Tag(tag)
    }
}

impl From<Vec<u32>> for Place {
    fn from(nodes: Vec<u32>) -> Self {
        Self::Nodes(nodes)
    }
}

impl From<&[u32]> for Place {
    fn from(nodes: &[u32]) -> Self {
        Self::Nodes(nodes.to_vec())
    }
}

impl<const N: usize> From<[u32; N]> for Place {
    fn from(nodes: [u32; N]) -> Self {
        Self::Nodes(nodes.to_vec())
    }
}

/// A support: directions of nodes that are fixed, or moved in a prescribed way.
#[derive(Debug, Clone)]
#[must_use]
pub struct Support {
    pub(crate) place: Place,
    pub(crate) directions: Directions,
    pub(crate) motion: Option<(Vec<[f64; 3]>, History)>,
    /// A point of the axis and its direction, of any length.
    pub(crate) axis: Option<([f64; 3], [f64; 3])>,
    pub(crate) span: Span,
    /// Factor of the displacements at its start.
    pub(crate) fading: Option<History>,
    /// The displacements at its start, one a node, m; none where it starts at rest.
    pub(crate) left: Vec<[f64; 3]>,
}

impl Support {
    /// All components are zero, on a tag or at nodes.
    ///
    /// ```
    /// use signorini_contact::Support;
    /// use signorini_fem_mesh::{brick, Brick};
    ///
    /// let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build()?;
    /// let clamp = Support::fixed(brick::X_MIN);
    /// let corners = Support::fixed([0, 4]);
    /// // the nodes around a bolt
    /// let near = |x: &[f64; 3]| (x[0] - 1.0).hypot(x[1] - 0.5) < 0.1;
    /// let bolt: Vec<u32> = (0..).zip(mesh.points()).filter(|(_, x)| near(x)).map(|(n, _)| n).collect();
    /// let bolt = Support::components(bolt, [true, true, false]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fixed(place: impl Into<Place>) -> Self {
        Self::partial(place, Directions::All)
    }

    /// Some directions are zero.
    ///
    /// ```
    /// use signorini_contact::{Directions, Support};
    /// # use signorini_fem_mesh::{Brick, Surface, brick};
    ///
    /// # let mesh = Brick::new([1.0; 3], [2; 3]).build()?;
    /// // nodes of a surface of any shape stay on it; in a mesh of order 2 its corners: mid-nodes are free
    /// let surface = Surface::new(&mesh, &[brick::X_MAX])?;
    /// let normals = surface.frames().iter().map(|frame| vec![frame.normal]).collect();
    /// let guide = Support::partial(surface.nodes(), Directions::EachNode(normals));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn partial(place: impl Into<Place>, directions: Directions) -> Self {
        Self {
            place: place.into(),
            directions,
            motion: None,
            axis: None,
            span: Span::default(),
            fading: None,
            left: Vec::new(),
        }
    }

    /// Single components (x, y, z) are zero.
    pub fn components(place: impl Into<Place>, components: [bool; 3]) -> Self {
        Self::partial(place, Directions::Components(components))
    }

    /// The fixed directions follow `history(t) * displacement` (m) instead of staying at zero.
    ///
    /// What it moves it must hold: a part of the displacement along x, y or z, or along those of its
    /// [axis](Self::with_axis), is refused if no fixed direction has a part along that. Of oblique directions, and of
    /// those of each node, such as the normals of a curved surface, what is along them counts.
    ///
    /// A support that prescribes the normal displacement of a contact node must keep it outside the obstacle at all
    /// times, since no contact force could; otherwise the scene is refused.
    ///
    /// It replaces a motion that was told before. Another course along x than along z is that of two supports of the
    /// same nodes, of [components](Self::components) of their own.
    ///
    /// Supports that share nodes must prescribe the same motion: equal displacements with equal histories, that is
    /// equal tables or clones of one function.
    pub fn with_motion(mut self, displacement: [f64; 3], history: History) -> Self {
        self.motion = Some((vec![displacement], history));
        self
    }

    /// The same with one displacement per node, in the order of the nodes (ascending for a tag). It replaces a motion
    /// that was told before, too.
    pub fn with_motions(mut self, displacements: Vec<[f64; 3]>, history: History) -> Self {
        self.motion = Some((displacements, history));
        self
    }

    /// Directions and displacements are radial, tangential (right-handed) and axial with respect to an axis through
    /// `point`, in place of x, y, z.
    ///
    /// ```
    /// use signorini_contact::Support;
    /// use signorini_fem_mesh::{FacetTag, History};
    ///
    /// # let (bore, rim) = (FacetTag(1), FacetTag(2));
    /// let (point, axis) = ([0.0; 3], [0.0, 0.0, 1.0]);
    /// let bearing = Support::components(bore, [true, false, false]).with_axis(point, axis);
    /// // the rim grows by a tenth of a millimetre
    /// let grown = Support::components(rim, [true, false, false])
    ///     .with_axis(point, axis)
    ///     .with_motion([1e-4, 0.0, 0.0], History::ramp(1.0, 1.0)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_axis(mut self, point: [f64; 3], axis: [f64; 3]) -> Self {
        self.axis = Some((point, axis));
        self
    }

    /// It holds at steps until a time, s, and from then on its nodes are free: a clamp is released. The reaction is
    /// gone at once, at the first step that ends later, however short that is. Between the two steps the scene is set
    /// up anew. That what is left holds the loads is checked beforehand, which takes one more set-up for each such
    /// time. The example is that of [`with_start`](Self::with_start).
    pub fn with_end(mut self, time: f64) -> Self {
        self.span.end = Some(time);
        self
    }

    /// It holds at steps that end later than a time, s; before, its nodes are free. It holds them where they are at the
    /// last step before, and displacements of a [motion](Self::with_motion) are added to that: let its history begin
    /// with zero there. Let the time be the end of a step, or halved steps hold them elsewhere. Directions of nodes
    /// that other supports hold, or have held for longer, stay with these until they end. Nodes that are held along the
    /// normal of a contact neither press nor rub there.
    ///
    /// ```
    /// use signorini_contact::{Analysis, Load, Scene, Settings, Simulation, Support};
    /// use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};
    ///
    /// // a bar is pulled, clamped as it is while the pull is taken away, and released
    /// let bar = Brick::new([0.2, 0.02, 0.02], [10, 2, 2]).build()?;
    /// let hat = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])?;
    /// let scene = Scene::new(bar, Materials::uniform(Hooke::isotropic(2e11, 0.3)?))
    ///     .with_support(Support::fixed(brick::X_MIN))
    ///     .with_support(Support::fixed(brick::X_MAX).with_start(1.0).with_end(2.0))
    ///     .with_load(Load::force(brick::X_MAX, [4e4, 0.0, 0.0]).with_history(hat))
    ///     .with_analysis(Analysis::quasistatic(3.0, 3));
    /// let mut simulation = Simulation::new(scene, Settings::default())?;
    /// simulation.step()?;
    /// let clamped = simulation.step()?;
    /// // the clamp keeps the force
    /// assert!((clamped.reactions().supports[1].resultant.force[0] - 4e4).abs() < 1.0);
    /// let released = simulation.step()?;
    /// assert_eq!(released.reactions().supports[1].resultant.force, [0.0; 3]);
    /// assert!(released.displacement().iter().all(|u| u[0].abs() < 1e-10));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_start(mut self, time: f64) -> Self {
        self.span.start = Some(time);
        self
    }

    /// The displacements at which it [starts](Self::with_start) count `history(t)` times: as this falls from
    /// one to zero, the nodes come back to where they were at rest, or, with a [motion](Self::with_motion) that grows
    /// meanwhile, to a place that is known beforehand. Of a support without a start it is refused.
    pub fn with_fading(mut self, history: History) -> Self {
        self.fading = Some(history);
        self
    }

    /// The time from which it holds, s; `None` from the beginning.
    pub fn start(&self) -> Option<f64> {
        self.span.start
    }

    /// The time until which it holds, s; `None` for ever.
    pub fn end(&self) -> Option<f64> {
        self.span.end
    }

    /// Where it acts.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// The directions that it fixes.
    pub fn directions(&self) -> &Directions {
        &self.directions
    }

    /// Its displacements (m; one for all nodes or one per node) and their history; `None` if it does not move.
    pub fn motion(&self) -> Option<(&[[f64; 3]], &History)> {
        let (values, history) = self.motion.as_ref()?;
        Some((values, history))
    }

    /// A point of the axis to which directions and displacements refer, and its direction; `None` where they are along
    /// x, y, z.
    pub fn axis(&self) -> Option<([f64; 3], [f64; 3])> {
        self.axis
    }
}
