#pragma once
#include <string>
#include <vector>

#include "tape/bodies/body_mass.hpp"
#include "tape/bodies/vertex_owner.hpp"
#include "tape/model/scene.hpp"
#include "tape/model/strip_mesh.hpp"

namespace tape {
/// A strip in the world's arrays.
struct StripPart {
  int film = 0;            ///< index into Scene::films
  int first_vertex = 0;    ///< its vertices and its blocks of unknowns are consecutive
  int first_triangle = 0;  ///< into Assembly::triangles
  int vertices = 0, triangles = 0, columns = 0;
  int hub = -1;  ///< body that it is wound on, -1 if none
};
/// A body in the world's arrays. Frame B of a body has its origin at the centre of mass.
struct BodyPart {
  Motion motion = Motion::fixed;
  int cluster_of = -1;  ///< strip whose wound part this is, -1: a body of the scene
  int first_vertex = 0, vertices = 0;
  int first_triangle = 0, triangles = 0;
  int block = -1;                                                 ///< first of its two blocks, -1 if fixed
  int centre = -1;                                                ///< vertex that marks the centre of mass, -1 if fixed
  BodyMass mass;                                                  ///< zero unless dynamic; a cluster's follows its members
  Pose start;                                                     ///< X_WB
  Vec3 mesh_offset = Vec3::Zero();                                ///< [m] centre of mass in the frame of the mesh
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();  ///< [m/s], [rad/s] at the start
};

/// An articulation in the world's arrays: three of its coordinates to a block, the last block filled up with some that move nothing.
struct ArticulationPart {
  int coordinates = 0;
  int first_block = 0, blocks = 0;
  std::vector<int> links;  ///< bodies
};

/// The scene as arrays. Vertices: those of the strips, of the bodies, then markers (points of bodies that no surface has). Bodies: those of
/// the scene, then the clusters of reduced rolls, which as yet have no members.
/// Unknowns are blocks of 3: two per body that is not fixed (translation, rotation), those of articulations, then one per strip vertex.
/// Blocks of links follow those of their articulation.
struct Assembly {
  std::vector<Vec3> x;             ///< [nv] m, at the start; zero where a cut has made a vertex
  std::vector<Vec3> v;             ///< [nv] m/s, at the start; strip vertices only
  std::vector<Vec2> rest;          ///< [nv] m, flat rest position; strip vertices only
  std::vector<VertexOwner> owner;  ///< [nv]
  std::vector<Vec3> local;         ///< [nv] m, in frame B; vertices of bodies only
  std::vector<Real> mass;          ///< [nv] kg: lumped on strip vertices (area/3 thickness density), whole body on its centre
  std::vector<Index3> triangles;   ///< of strips, then of bodies
  std::vector<StripPart> strips;   ///< in the order of the scene
  std::vector<BodyPart> bodies;
  std::vector<ArticulationPart> articulations;
  int strip_vertices = 0;    ///< vertices below this are those of strips
  int surface_vertices = 0;  ///< vertices below this have a surface, those from it on are markers
  int blocks = 0;
  int first_strip_block = 0;  ///< blocks below this are those of bodies and articulations

  /// Points that a grip holds, and the marker of each on the body it ties to (-1: a target moved by the script).
  struct GripPart {
    std::vector<int> vertices, anchors;
    Real stiffness;  ///< [N/m] of each spring
  };
  std::vector<GripPart> grips;
  /// Markers of a revolute joint. Its ends stand on the body, as far apart as the body is large, its seats where they are on what the body
  /// turns on. From the first end an arm stands off the axis, and from the first seat two dials: one where the arm is, one a right angle
  /// on.
  struct AxlePart {
    int end[2], seat[2], arm, dial[2];
    Real stiffness;  ///< [N/m] of the hold on each end
  };
  std::vector<AxlePart> axles;
  int cluster_body(int strip) const;  ///< body that is the cluster of a strip, -1 if it is not reduced
};

/// @throws InputError naming the object if something cannot be built (open dynamic body, grip on an unknown object, ...)
Assembly assemble(const Scene& scene);
}  // namespace tape
