#pragma once
#include "robot/model/robot_model.hpp"

/// Masses that move together. With S = integral of x x^T dm, the inertia about the same point is tr(S) I - S.
namespace robot {
/// The same body, seen from another frame.  @param X_AB  of the frame that `body` is given in
Inertial moved(const Pose& X_AB, const Inertial& body);
/// Two bodies as one, both in the same frame: parallel axis theorem.
Inertial combined(const Inertial& a, const Inertial& b);
/// A solid of constant density [kg/m^3], exact for the polyhedron. Assumes a closed mesh, counterclockwise from outside.
Inertial solid(const TriangleMesh& mesh, Real density);
/// [kg m^2] ascending.
Vec3 principal_moments(const Mat3& inertia);
}  // namespace robot
