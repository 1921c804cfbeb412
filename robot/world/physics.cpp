#include "robot/world/physics.hpp"

#include <algorithm>
#include <cmath>

namespace robot {
namespace {
constexpr Real kReach = 2e-3;  // [m] from which a contact is a row for the solver: surfaces stop at each other, not after

DrivenRobot& robot_of(const btMultiBody& body) { return *static_cast<DrivenRobot*>(body.getUserPointer()); }
LinkId id(const btCollisionObject& collider) { return {collider.getUserIndex(), collider.getUserIndex2()}; }
}  // namespace

/// Which links may touch is asked in every substep, so that it may change at any time.
class Physics::Dispatcher : public btCollisionDispatcher {
 public:
  Dispatcher(btDefaultCollisionConfiguration& configuration, const Physics& physics)
      : btCollisionDispatcher(&configuration), physics_(physics) {
    setDispatcherFlags(getDispatcherFlags() & ~CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD);
    set_algorithms(configuration);
  }
  bool needsCollision(const btCollisionObject* a, const btCollisionObject* b) override {
    if (a->getCollisionShape()->getShapeType() == EMPTY_SHAPE_PROXYTYPE || b->getCollisionShape()->getShapeType() == EMPTY_SHAPE_PROXYTYPE)
      return false;
    if (!moves(*a) && !moves(*b)) return false;
    return !physics_.apart.contains(std::minmax(id(*a), id(*b)));
  }

 private:
  /// A face that lies on another touches it in up to four points. Bullet finds them by tilting one of both around. Its own way for two
  /// boxes sees only points that already penetrate, so boxes go the way of all convex shapes. A sphere touches in one point.
  void set_algorithms(btDefaultCollisionConfiguration& configuration) {
    constexpr int kTilts = 8, kPoints = 4;
    configuration.setConvexConvexMultipointIterations(kTilts, kPoints);
    constexpr int kBox = BOX_SHAPE_PROXYTYPE, kHull = CONVEX_HULL_SHAPE_PROXYTYPE, kSphere = SPHERE_SHAPE_PROXYTYPE;
    registerCollisionCreateFunc(kBox, kBox, configuration.getCollisionAlgorithmCreateFunc(kHull, kHull));
    for (const int shape : {kBox, kHull}) {
      registerCollisionCreateFunc(shape, kSphere, &one_point_);
      registerCollisionCreateFunc(kSphere, shape, &one_point_);
    }
  }
  static bool moves(const btCollisionObject& object) {
    const auto& collider = static_cast<const btMultiBodyLinkCollider&>(object);
    return collider.m_link >= 0 || !collider.m_multiBody->hasFixedBase();
  }
  const Physics& physics_;
  btGjkEpaPenetrationDepthSolver penetration_;
  btConvexConvexAlgorithm::CreateFunc one_point_{&penetration_};
};

/// Bullet's solver, in which a robot gives way to an impulse as it does with its drives' stiffness and damping in the substep, and
/// with mimicking joints following: Bullet alone takes the bare mass matrix, and a stiff drive then presses with a fraction of its force.
class Physics::Solver : public btMultiBodyConstraintSolver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override {
    btMultiBodyConstraintSolver::convertContacts(manifolds, count, info);
    for (btMultiBodyConstraintArray* rows :
         {&m_multiBodyNonContactConstraints, &m_multiBodyNormalContactConstraints, &m_multiBodyFrictionContactConstraints,
          &m_multiBodySpinningFrictionContactConstraints, &m_multiBodyTorsionalFrictionContactConstraints})
      for (int i = 0; i < rows->size(); ++i) adapt((*rows)[i]);
  }

 private:
  void adapt(btMultiBodySolverConstraint& row) {
    Real give = 0;  // change of the row's velocity per impulse
    if (row.m_multiBodyA) give += respond(*row.m_multiBodyA, row.m_jacAindex, row.m_multiBodyA == row.m_multiBodyB ? row.m_jacBindex : -1);
    if (row.m_multiBodyB) give += respond(*row.m_multiBodyB, row.m_jacBindex, row.m_multiBodyA == row.m_multiBodyB ? row.m_jacAindex : -1);
    const Real ratio = give > 0 && row.m_jacDiagABInv > 0 ? 1 / (give * row.m_jacDiagABInv) : 0;
    row.m_jacDiagABInv *= ratio;
    row.m_rhs *= ratio;
  }
  Real respond(const btMultiBody& body, int at, int other) {
    const MatX& response = robot_of(body).impulse_response();
    Eigen::Map<VecX> jacobian(&m_data.m_jacobians[at], response.rows());
    Eigen::Map<VecX> velocity(&m_data.m_deltaVelocitiesUnitImpulse[at], response.rows());
    velocity = response * jacobian;
    Real give = jacobian.dot(velocity);
    if (other >= 0) give += Eigen::Map<const VecX>(&m_data.m_jacobians[other], response.rows()).dot(velocity);
    return give;
  }
};

class Physics::BulletWorld : public btMultiBodyDynamicsWorld {
 public:
  BulletWorld(Physics& physics, const WorldParams& params)
      : btMultiBodyDynamicsWorld(physics.dispatcher_.get(), physics.broadphase_.get(), physics.solver_.get(), physics.configuration_.get()),
        physics_(physics) {
    constexpr Real kStill = 1e-10;  // [m/s, rad/s] a sweep that changes no row by more ends the solve
    setGravity({0, 0, 0});          // ours: Articulation
    getDispatchInfo().m_deterministicOverlappingPairs = true;
    btContactSolverInfo& info = getSolverInfo();
    info.m_numIterations = params.iterations;
    info.m_leastSquaresResidualThreshold = kStill * kStill;
    info.m_solverMode = SOLVER_SIMD | SOLVER_USE_2_FRICTION_DIRECTIONS;  // no warm start, no random order
    info.m_splitImpulse = 0;                                             // which articulations do not know
    info.m_erp = params.limit_erp;
    info.m_erp2 = params.contact_erp;
    info.m_restitution = 0;
  }

  /// Bullet leaves out the constraints of articulations where it does not split islands, and splitting orders them by history.
  void solveConstraints(btContactSolverInfo& info) override {
    constexpr int kReleasing = 8;  // passes in which drives may leave their limits and joints stick; after them neither, which ends
    forwardKinematics();
    bool again = true;
    for (int pass = 0; again; ++pass) {
      again = false;
      clearMultiBodyConstraintForces();
      physics_.unsettled += pass == kReleasing;
      for (const auto& robot : physics_.robots_) robot->move_freely();
      solve(info);
      for (const auto& robot : physics_.robots_) again |= robot->update_active_sets(pass < kReleasing);
    }
    for (const auto& robot : physics_.robots_) robot->set_drift();
  }

 private:
  void solve(btContactSolverInfo& info) {
    btDispatcher& dispatcher = *getDispatcher();
    m_multiBodyConstraintSolver->prepareSolve(m_collisionObjects.size(), dispatcher.getNumManifolds());
    m_multiBodyConstraintSolver->solveMultiBodyGroup(
        m_collisionObjects.size() ? &m_collisionObjects[0] : nullptr, m_collisionObjects.size(), dispatcher.getInternalManifoldPointer(),
        dispatcher.getNumManifolds(), nullptr, 0, m_multiBodyConstraints.size() ? &m_multiBodyConstraints[0] : nullptr,
        m_multiBodyConstraints.size(), info, nullptr, &dispatcher);
    m_multiBodyConstraintSolver->allSolved(info, nullptr);
    for (int i = 0; i < m_multiBodies.size(); ++i) m_multiBodies[i]->processDeltaVeeMultiDof2();
  }
  Physics& physics_;
};

Physics::Physics(const WorldParams& params)
    : params_(params),
      configuration_(std::make_unique<btDefaultCollisionConfiguration>()),
      dispatcher_(std::make_unique<Dispatcher>(*configuration_, *this)),
      broadphase_(std::make_unique<btSimpleBroadphase>()),
      solver_(std::make_unique<Solver>()),
      world_(std::make_unique<BulletWorld>(*this, params)) {
  gContactBreakingThreshold = kReach;
}

Physics::~Physics() {
  for (const auto& robot : robots_) {
    for (const auto& constraint : robot->constraints()) world_->removeMultiBodyConstraint(constraint.get());
    world_->removeMultiBody(&robot->body().bullet());
  }
}

DrivenRobot& Physics::add(const std::shared_ptr<const RobotModel>& model, const RobotParams& params) {
  const int index = static_cast<int>(robots_.size());
  auto robot = std::make_unique<DrivenRobot>(index, model, params);
  for (const auto& [a, b] : model->may_overlap) apart.insert(std::minmax(LinkId(index, a), LinkId(index, b)));
  world_->addMultiBody(&robot->body().bullet());
  for (int link = 0; link <= robot->body().joints(); ++link)
    world_->addCollisionObject(&robot->body().collider(link), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
  for (const auto& constraint : robot->constraints()) world_->addMultiBodyConstraint(constraint.get());
  robots_.push_back(std::move(robot));
  return *robots_.back();
}

/// Contacts of a substep may not depend on those of another: pairs are built anew, in the order of the colliders.
void Physics::forget_contacts() {
  btBroadphasePairArray& pairs = broadphase_->getOverlappingPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) broadphase_->getOverlappingPairCache()->cleanOverlappingPair(pairs[i], dispatcher_.get());
}

void Physics::substep(Real h, const std::vector<VecX>& tau) {
  forget_contacts();
  for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i]->begin(tau[i], params_.gravity, h);
  world_->stepSimulation(h, 0);
  for (const auto& robot : robots_) robot->end();
}

std::vector<Contact> Physics::overlaps() {
  forget_contacts();
  world_->performDiscreteCollisionDetection();
  std::vector<Contact> found = points(1);
  std::erase_if(found, [](const Contact& c) { return c.distance >= 0; });
  std::ranges::sort(found, {}, &Contact::distance);
  return found;
}

void Physics::add_contacts(Real h, Real dt, std::vector<Contact>& contacts) const {
  constexpr Real kAlike = 0.9;  // cosine between normals of what is one contact
  for (Contact now : points(h)) {
    if (now.force.isZero(0)) continue;
    now.force *= h / dt;
    const auto same = std::ranges::find_if(contacts, [&](const Contact& c) {
      return c.robot_a == now.robot_a && c.link_a == now.link_a && c.robot_b == now.robot_b && c.link_b == now.link_b &&
             (c.point - now.point).norm() < kReach && c.normal.dot(now.normal) > kAlike;
    });
    if (same == contacts.end()) {
      contacts.push_back(now);
      continue;
    }
    now.force += same->force;
    *same = now;
  }
}

std::vector<Contact> Physics::points(Real h) const {
  std::vector<Contact> points;
  for (int m = 0; m < dispatcher_->getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(m);
    const auto [robot_a, link_a] = id(*manifold.getBody0());
    const auto [robot_b, link_b] = id(*manifold.getBody1());
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& p = manifold.getContactPoint(i);
      const btVector3 impulse = p.m_appliedImpulse * p.m_normalWorldOnB + p.m_appliedImpulseLateral1 * p.m_lateralFrictionDir1 +
                                p.m_appliedImpulseLateral2 * p.m_lateralFrictionDir2;
      points.push_back({robot_a, link_a, robot_b, link_b, from_bullet(p.getPositionWorldOnB()), from_bullet(p.m_normalWorldOnB),
                        from_bullet(impulse) / h, p.m_combinedFriction, p.getDistance()});
    }
  }
  return points;
}
}  // namespace robot
