//! Contact that gives way: rough surfaces, and the slopes of penalty codes.

use super::contact::Contact;

impl Contact {
    /// Rough surfaces give way under pressure: where they touch, the distance is `-compliance` (m/Pa) times the
    /// pressure, a negative gap in [`PointState`](crate::PointState). Zero, the default, is the exact law. The inverse
    /// is the contact stiffness of other codes (N/m³, the slope of a linear pressure-overclosure).
    ///
    /// Contacts that meet a node along one direction need the same compliances and gaps. A node that a support holds
    /// along the normal still may not be inside the obstacle: no pressure is known there.
    pub fn with_normal_compliance(mut self, compliance: f64) -> Self {
        self.compliance[0] = compliance;
        self
    }

    /// Elastic slip: below the slip bound a point moves along the surface by `compliance` (m/Pa) times the friction
    /// stress, and goes back with it. The inverse is the stick slope of other codes (N/m³). Zero, the default, is
    /// Coulomb's law as it stands. Without friction it has no effect.
    ///
    /// Differences, slip rates and friction work of results are those of the slip beyond it, which is lost.
    pub fn with_tangential_compliance(mut self, compliance: f64) -> Self {
        self.compliance[1] = compliance;
        self
    }

    /// Compliance along the normal and along the surface, m/Pa; zero for the exact law.
    pub fn compliance(&self) -> [f64; 2] {
        self.compliance
    }
}
