// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/physics.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <btBulletDynamicsCommon.h>

namespace bpa::sim {
namespace {

// Bullet's tolerances are made for bodies of about a metre: lengths and gravity are ten times ours.
constexpr double kScale = 10;
constexpr double kStep = 1.0 / 180;
constexpr double kMargin = 0.0003;  // metres, round every convex part
constexpr btScalar kMass = 0.3f;    // kilograms
constexpr int kFenceSides = 12;

btVector3 to_bullet(const Eigen::Vector3d& v) {
  const Eigen::Vector3f scaled = (kScale * v).cast<float>();
  return {scaled.x(), scaled.y(), scaled.z()};
}

btTransform to_bullet(const Pose& pose) {
  const Eigen::Quaternionf q = pose.rotation.cast<float>();
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bullet(pose.translation));
}

Pose from_bullet(const btTransform& transform) {
  const btQuaternion q = transform.getRotation();
  const btVector3& t = transform.getOrigin();
  return {Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized(),
          Eigen::Vector3d(t.x(), t.y(), t.z()) / kScale};
}

// A world and everything that lives in it.
class World {
 public:
  World()
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(to_bullet({0, 0, -9.81}));
    world_.getSolverInfo().m_numIterations = 10;
  }
  ~World() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  btRigidBody* add_static_box(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size,
                              double angle = 0) {
    const Pose pose{rotation_from_vector(angle * Eigen::Vector3d::UnitZ()), center};
    return add(std::make_unique<btBoxShape>(to_bullet(half_size)), pose, 0);
  }

  btRigidBody* add_object(const SimulatedObject& object, const Eigen::Vector3d& center,
                          const Pose& world_from_object, btScalar mass) {
    auto compound = std::make_unique<btCompoundShape>();
    for (const ConvexPart& part : object.parts) {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const Eigen::Vector3f& point : part) {
        hull->addPoint(to_bullet(point.cast<double>() - center), false);
      }
      hull->recalcLocalAabb();
      hull->setMargin(kScale * kMargin);
      compound->addChildShape(btTransform::getIdentity(), hull.get());
      shapes_.push_back(std::move(hull));
    }
    const Pose world_from_body = world_from_object * Pose{Eigen::Quaterniond::Identity(), center};
    return add(std::move(compound), world_from_body, mass);
  }

  void remove(btRigidBody* body) {
    world_.removeRigidBody(body);
    std::erase_if(bodies_, [body](const auto& b) { return b.get() == body; });
    for (const auto& b : bodies_) b->activate(true);
  }
  void step() { world_.stepSimulation(kStep, 1, kStep); }

 private:
  btRigidBody* add(std::unique_ptr<btCollisionShape> shape, const Pose& pose, btScalar mass) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform = to_bullet(pose);
    info.m_friction = 1.0f;
    info.m_rollingFriction = 0.05f;
    info.m_spinningFriction = 0.01f;
    info.m_restitution = 0.05f;
    info.m_linearDamping = 0.3f;
    info.m_angularDamping = 0.6f;
    info.m_linearSleepingThreshold = 0.01 * kScale;
    info.m_angularSleepingThreshold = 0.15f;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    shapes_.push_back(std::move(shape));
    world_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDiscreteDynamicsWorld world_;
};

std::vector<btRigidBody*> add_fence(World& world, double radius) {
  std::vector<btRigidBody*> fence;
  for (int i = 0; i < kFenceSides && radius > 0; ++i) {
    const double angle = 2 * std::numbers::pi * i / kFenceSides;
    constexpr double kThickness = 0.05;
    const Eigen::Vector3d center((radius + kThickness) * std::cos(angle),
                                 (radius + kThickness) * std::sin(angle), 1);
    const double half_width = radius * std::tan(std::numbers::pi / kFenceSides) + kThickness;
    fence.push_back(world.add_static_box(center, {kThickness, half_width, 1}, angle));
  }
  return fence;
}

// The height at which a body can be let go over what already lies there.
double free_height(const std::vector<btRigidBody*>& placed) {
  double top = 0;
  for (const btRigidBody* body : placed) {
    btVector3 low, high;
    body->getAabb(low, high);
    if (low.z() > -0.05 * kScale) top = std::max<double>(top, high.z() / kScale);
  }
  return top;
}

bool all_asleep(const std::vector<btRigidBody*>& bodies) {
  return std::ranges::all_of(bodies, [](const btRigidBody* b) {
    return !b->isActive() || b->getWorldTransform().getOrigin().z() < -0.1 * kScale;
  });
}

}  // namespace

Eigen::Vector3d center_of_mass(const TriangleMesh& mesh) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>();
    const double tetrahedron = a.dot(b.cross(c)) / 6;
    volume += tetrahedron;
    moment += tetrahedron * (a + b + c) / 4;
  }
  return std::abs(volume) > 1e-12 ? Eigen::Vector3d(moment / volume) : Eigen::Vector3d::Zero();
}

std::vector<RestingBody> drop(const std::vector<FallingBody>& bodies, const DropOptions& options) {
  World world;
  world.add_static_box({0, 0, -0.05}, {options.table_half_x, options.table_half_y, 0.05});
  if (options.fixture != nullptr) {
    world.add_object(*options.fixture, Eigen::Vector3d::Zero(), Pose{}, 0);
  }
  std::vector<btRigidBody*> fence = add_fence(world, options.fence_radius);

  std::vector<btRigidBody*> falling;
  std::vector<Eigen::Vector3d> centers;
  const auto steps_of = [](double seconds) { return static_cast<int>(seconds / kStep); };
  for (const FallingBody& body : bodies) {
    Pose start = body.world_from_object;
    double radius = 0;
    for (const ConvexPart& part : body.object->parts) {
      for (const Eigen::Vector3f& p : part) radius = std::max<double>(radius, p.norm());
    }
    start.translation.z() = std::max(start.translation.z(), free_height(falling) + radius + 0.01);
    centers.push_back(center_of_mass(body.object->mesh));
    falling.push_back(world.add_object(*body.object, centers.back(), start, kMass));
    for (int i = 0; i < steps_of(options.interval); ++i) world.step();
  }
  for (int i = 0; i < steps_of(0.6); ++i) world.step();
  for (btRigidBody* wall : fence) world.remove(wall);
  const int remaining =
      steps_of(options.max_seconds - options.interval * static_cast<double>(bodies.size()) - 0.6);
  for (int i = 0; i < remaining && !all_asleep(falling); ++i) world.step();

  std::vector<RestingBody> result;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    RestingBody rest{from_bullet(falling[i]->getWorldTransform()) *
                     Pose{Eigen::Quaterniond::Identity(), -centers[i]}};
    if (falling[i]->isActive()) {
      rest.speed = falling[i]->getLinearVelocity().length() / kScale;
      rest.turning = falling[i]->getAngularVelocity().length();
    }
    rest.on_table = rest.world_from_object.translation.z() > -0.02;
    result.push_back(rest);
  }
  return result;
}

}  // namespace bpa::sim
