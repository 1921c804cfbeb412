#pragma once
#include <vector>

#include "tape/contact/surface.hpp"

namespace tape {
/// Objects that must take steps of one length: those that candidates connect, directly or through others, those that one rigid body or
/// articulation moves, what rides a body and that body, and those that springs tie. Objects that cannot move connect nothing. Host only.
class ObjectGroups {
 public:
  explicit ObjectGroups(const SurfaceMesh& mesh);
  /// Starts anew from the constant connections and joins a and b wherever touching[a objects + b] is 0.
  void join(const std::vector<Real>& touching);
  int objects() const { return static_cast<int>(component_of_object.size()); }

  std::vector<int> component_of_object;  ///< [objects] -1: fixed
  std::vector<int> object_of_block;      ///< [nb] -1: moves no vertex
  int components = 0;

 private:
  int root(int object);
  void join(int a, int b);
  void number_components();
  std::vector<int> parent_, constant_parent_;  ///< [objects]
  std::vector<bool> fixed_;                    ///< [objects]
};
}  // namespace tape
