#include "calibrato/motion/arm_file.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

Vector3d ToVector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Rigid3 ToRigid3(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix(),
          ToVector(pose.position)};
}

// What the parser says goes into our own line, not onto the terminal.
class CaughtMessages : public console_bridge::OutputHandler {
 public:
  CaughtMessages() : before_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~CaughtMessages() override { console_bridge::useOutputHandler(before_); }
  CaughtMessages(const CaughtMessages&) = delete;
  CaughtMessages& operator=(const CaughtMessages&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (first_.empty() && level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) first_ = text;
  }
  [[nodiscard]] std::string First() const {
    std::string line = first_.empty() ? "it is not a robot's description" : first_;
    std::ranges::replace(line, '\n', ' ');
    return line;
  }

 private:
  console_bridge::OutputHandler* before_;
  std::string first_;
};

urdf::ModelInterfaceSharedPtr ReadUrdf(const std::string& path) {
  const std::string text = ReadFile(path);
  CaughtMessages messages;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (model) return model;
  throw InputError({"cannot read the URDF", path, messages.First(),
                    "if it is xacro, expand it first: xacro FILE.xacro > FILE.urdf"});
}

// From the base to the tool.
std::vector<urdf::JointConstSharedPtr> JointsBetween(const urdf::ModelInterface& model,
                                                     const Value& file, const std::string& path) {
  const std::string base = file.At("base_link").AsString();
  const std::string tool = file.At("tool_link").AsString();
  for (const auto& [name, key] : {std::pair{base, "base_link"}, {tool, "tool_link"}}) {
    if (model.getLink(name)) continue;
    file.At(key).Fail("no such link", "the URDF " + path + " has none of the name " + name,
                      "name one of its links");
  }
  std::vector<urdf::JointConstSharedPtr> joints;
  for (urdf::LinkConstSharedPtr link = model.getLink(tool); link->name != base;
       link = link->getParent()) {
    if (!link->parent_joint) {
      file.At("tool_link")
          .Fail("no chain of joints", tool + " does not hang on " + base,
                "name two links of one arm, the base first");
    }
    joints.push_back(link->parent_joint);
    if (joints.size() > model.joints_.size()) {
      file.At("tool_link")
          .Fail("no chain of joints", "in the URDF " + path + " joints lead in a circle",
                "let every link hang on one other, up to the base");
    }
  }
  std::ranges::reverse(joints);
  return joints;
}

// One number a joint, the rest for the joint that the arm may lack.
JointVector PerJoint(const Value& value, size_t num_joints, double rest) {
  const std::vector<double> numbers = value.AsDoubles(num_joints);
  JointVector vector = JointVector::Constant(rest);
  for (size_t i = 0; i < num_joints; ++i) vector[static_cast<Eigen::Index>(i)] = numbers[i];
  return vector;
}

JointVector PositivePerJoint(const Value& value, size_t num_joints) {
  const JointVector vector = PerJoint(value, num_joints, std::numeric_limits<double>::infinity());
  if (!(vector.minCoeff<Eigen::PropagateNaN>() > 0.0)) {
    value.Fail("bad limit", "limits are above 0", "write one positive number a joint");
  }
  return vector;
}

// Whether the lengths that a shape is given by are above 0; of a mesh none are read.
bool HasSize(const urdf::Geometry& shape) {
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&shape)) return sphere->radius > 0.0;
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&shape)) {
    return cylinder->radius > 0.0 && cylinder->length > 0.0;
  }
  if (const auto* box = dynamic_cast<const urdf::Box*>(&shape)) {
    return ToVector(box->dim).minCoeff<Eigen::PropagateNaN>() > 0.0;
  }
  return true;
}

// The capsule around a shape, in the shape's own frame; nothing of a mesh.
std::optional<Capsule> CapsuleAround(const urdf::Geometry& shape) {
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&shape)) {
    return Capsule{Vector3d::Zero(), Vector3d::Zero(), sphere->radius};
  }
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&shape)) {
    const Vector3d end(0.0, 0.0, 0.5 * cylinder->length);
    return Capsule{-end, end, cylinder->radius};
  }
  if (const auto* box = dynamic_cast<const urdf::Box*>(&shape)) {
    const Vector3d half = 0.5 * ToVector(box->dim);
    Eigen::Index longest = 0;
    half.maxCoeff(&longest);
    Vector3d end = Vector3d::Zero();
    end[longest] = half[longest];
    return Capsule{-end, end, std::sqrt(half.squaredNorm() - half[longest] * half[longest])};
  }
  return std::nullopt;
}

Capsule Moved(const Rigid3& T, const Capsule& capsule) {
  return {T * capsule.a, T * capsule.b, capsule.radius_m};
}

// Where a link of the arm is: fixed to this joint's frame.
struct LinkPlace {
  urdf::LinkConstSharedPtr link;
  int joint;  // from 1; 0 is the base
  Rigid3 T_joint_link;
};

// With the links behind them on fixed joints: brackets, a gripper, what stands on the base. What
// hangs on a joint of its own is named in a warning: nobody says where it is.
std::vector<LinkPlace> WithFixedLinks(const urdf::ModelInterface& model,
                                      std::vector<LinkPlace> places, const std::string& path,
                                      std::vector<std::string>* warnings) {
  std::set<std::string> known;
  for (const LinkPlace& place : places) known.insert(place.link->name);
  for (size_t i = 0; i < places.size(); ++i) {
    const LinkPlace place = places[i];  // a copy, since the list grows
    for (const urdf::JointSharedPtr& joint : place.link->child_joints) {
      if (!known.insert(joint->child_link_name).second) continue;
      if (joint->type == urdf::Joint::FIXED) {
        places.push_back({model.getLink(joint->child_link_name), place.joint,
                          place.T_joint_link * ToRigid3(joint->parent_to_joint_origin_transform)});
      } else if (warnings != nullptr) {
        warnings->push_back(
            "link " + joint->child_link_name + " hangs on joint " + joint->name +
            ", which is none of the arm's, " + path +
            ": it is not kept out of anything; give capsules that hold all its way");
      }
    }
  }
  return places;
}

[[noreturn]] void FailOnJoint(const urdf::Joint& joint, const std::string& path,
                              const std::string& why, const std::string& remedy) {
  throw InputError({"bad joint " + joint.name, path, why, remedy});
}

}  // namespace

Arm ReadArm(const std::string& path, std::vector<std::string>* warnings) {
  const Value file = ReadYaml(path);
  if (warnings != nullptr) {
    const auto unknown = file.UnknownKeys({"name", "urdf", "base_link", "tool_link",
                                           "start_joints_rad", "max_acceleration_rad_s2",
                                           "max_jerk_rad_s3", "max_velocity_rad_s", "capsules"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  const std::string urdf_path =
      (std::filesystem::path(path).parent_path() / file.At("urdf").AsString()).string();
  const urdf::ModelInterfaceSharedPtr model = ReadUrdf(urdf_path);

  Arm arm;
  arm.name = file.At("name").AsString();
  arm.base_frame = file.At("base_link").AsString();
  arm.limits.lower.setConstant(-1.0);
  arm.limits.upper.setConstant(1.0);
  arm.limits.velocity.setConstant(std::numeric_limits<double>::infinity());
  arm.limits.torque.setConstant(std::numeric_limits<double>::infinity());
  std::vector<LinkPlace> places = {{model->getLink(arm.base_frame), 0, {}}};
  Rigid3 T_joint_next;  // what fixed joints have gathered since the last that turns
  for (const urdf::JointConstSharedPtr& joint : JointsBetween(*model, file, path)) {
    T_joint_next = T_joint_next * ToRigid3(joint->parent_to_joint_origin_transform);
    if (joint->type != urdf::Joint::FIXED) {
      const bool turns =
          joint->type == urdf::Joint::REVOLUTE || joint->type == urdf::Joint::CONTINUOUS;
      if (!turns || !joint->limits) {
        FailOnJoint(*joint, urdf_path,
                    turns ? "it has no limits" : "only joints that turn are planned for",
                    turns ? "write limit lower, upper and velocity" : "use an arm without it");
      }
      const auto i = static_cast<Eigen::Index>(arm.joints.size());
      if (i == 7) {
        FailOnJoint(*joint, urdf_path, "it is the eighth between the two links",
                    "name links with six or seven joints between them");
      }
      const bool is_endless = joint->type == urdf::Joint::CONTINUOUS;
      constexpr double kFullTurn = 2.0 * std::numbers::pi;
      arm.limits.lower[i] = is_endless ? -kFullTurn : joint->limits->lower;
      arm.limits.upper[i] = is_endless ? kFullTurn : joint->limits->upper;
      arm.limits.velocity[i] = joint->limits->velocity;
      if (!(arm.limits.upper[i] > arm.limits.lower[i]) || !(arm.limits.velocity[i] > 0.0)) {
        FailOnJoint(*joint, urdf_path, "its limits leave no room",
                    "write lower < upper and a velocity above 0");
      }
      const Vector3d axis = ToVector(joint->axis);
      if (!(axis.norm() > 0.0)) {
        FailOnJoint(*joint, urdf_path, "its axis is 0 0 0", "write the axis that it turns about");
      }
      arm.joints.push_back({joint->name, T_joint_next, axis.normalized()});
      T_joint_next = {};
    }
    places.push_back({model->getLink(joint->child_link_name), arm.num_joints(), T_joint_next});
  }
  arm.T_last_e = T_joint_next;
  if (arm.num_joints() < 6) {
    file.At("tool_link")
        .Fail("too few joints", std::to_string(arm.num_joints()) + " turn between the two links",
              "an arm needs six or seven to bring a camera anywhere");
  }
  const size_t n = arm.joints.size();
  arm.start = PerJoint(file.At("start_joints_rad"), n, 0.0);
  if (!(JointLimitExcess(arm.start, {arm.limits.lower, arm.limits.upper}) <= 0.0)) {
    file.At("start_joints_rad")
        .Fail("bad start", "a joint is beyond its limit", "give angles within the URDF's limits");
  }
  arm.limits.acceleration = PositivePerJoint(file.At("max_acceleration_rad_s2"), n);
  arm.limits.jerk = PositivePerJoint(file.At("max_jerk_rad_s3"), n);
  if (const Value* velocity = file.Find("max_velocity_rad_s")) {
    arm.limits.velocity = arm.limits.velocity.cwiseMin(PositivePerJoint(*velocity, n));
  }

  places = WithFixedLinks(*model, std::move(places), urdf_path, warnings);
  const auto add = [&](const LinkPlace& place, const Rigid3& T_link_shape, const Capsule& capsule) {
    arm.parts.push_back(
        {place.link->name, place.joint, Moved(place.T_joint_link * T_link_shape, capsule)});
  };
  for (const LinkPlace& place : places) {
    for (const urdf::CollisionSharedPtr& collision : place.link->collision_array) {
      if (!collision->geometry) continue;
      if (!HasSize(*collision->geometry)) {
        throw InputError({"bad shape of link " + place.link->name, urdf_path,
                          "its lengths are not above 0", "write its sizes in metres"});
      }
      const std::optional<Capsule> capsule = CapsuleAround(*collision->geometry);
      if (capsule) add(place, ToRigid3(collision->origin), *capsule);
    }
  }
  if (const Value* capsules = file.Find("capsules")) {
    for (const Value& entry : capsules->elements()) {
      const std::string link = entry.At("link").AsString();
      const auto place = std::ranges::find_if(
          places, [&](const LinkPlace& known) { return known.link->name == link; });
      if (place == places.end()) {
        entry.At("link").Fail("no such link", link + " is neither of the arm nor fixed to it",
                              "name a link between base_link and tool_link");
      }
      add(*place, {},
          {Vector3d(entry.At("a").AsDoubles(3).data()), Vector3d(entry.At("b").AsDoubles(3).data()),
           entry.At("radius_m").AsPositive()});
    }
  }
  if (warnings != nullptr) {
    // The frame between a joint and the next needs a shape where there is length to it.
    for (int joint = 1; joint <= arm.num_joints(); ++joint) {
      if (std::ranges::any_of(arm.parts, [&](const ArmPart& p) { return p.link == joint; })) {
        continue;
      }
      warnings->push_back("no shape after joint " +
                          arm.joints[static_cast<size_t>(joint) - 1].name + ", " + path +
                          ": it is not kept out of anything; give capsules");
    }
  }
  return arm;
}

}  // namespace calibrato
