#pragma once

#include "tactus/control/controller.h"

namespace tactus {

/// Visits what the structs of a controller's state hold, each taken apart as a whole, so that a
/// member added to one of them does not compile before it is visited here.
template <typename Visit>
struct StateVisitor {
  const Visit& visit;

  template <typename Values>
  void list(const char* name, const Values& values) const {
    for (Eigen::Index i = 0; i < values.size(); ++i) visit(name, static_cast<int>(i), values[i]);
  }

  void point(const char* force, const char* position, const char* direction_name,
             const ContactPointState& contact) const {
    const auto& [force_N, position_m, direction, interval_s] = contact;
    visit(force, 0, force_N);
    visit(position, 0, position_m);
    list(direction_name, direction);
  }

  void all(const ControllerState& state) const {
    const auto& [q_desired, velocity_before, fault, is_stopping, waited_s, progress, return_share,
                 way_out_before, way_out_added, is_leaning, has_leaned, speed_share, modules,
                 contact, several, zones, retreat, tool_motion] = state;
    visit("speed_share", 0, speed_share);
    visit("waited_s", 0, waited_s);
    visit("progress", 0, progress);
    visit("return_share", 0, return_share);
    list("way_out_before", way_out_before);
    list("way_out_added", way_out_added);
    list("q_desired", q_desired);
    list("velocity_before", velocity_before);
    const auto& [sequence, age_s, sample_fault, detail, sensed_contact, hardest, excess, has_excess,
                 cover, is_lost, unproven_s] = modules.front();
    visit("unproven_s", 0, unproven_s);
    visit("sample_age_s", 0, age_s);
    point("force_N", "position_m", "direction", sensed_contact);
    point("hardest.force_N", "hardest.position_m", "hardest.direction", hardest);
    point("excess.force_N", "excess.position_m", "excess.direction", excess);
    compensation(cover);
    answer(contact);
    wayOut(retreat);
  }

  void wayOut(const RetreatState& retreat) const {
    const auto& [is_under_way, is_over, has_moved, is_felt, is_free, has_push, is_placed, module,
                 push, direction, velocity_at_fault, way_out, stiffness, untold_s, row, time_s,
                 free_s, way, way_to, speed, marked_N, way_at_mark] = retreat;
    point("retreat.force_N", "retreat.position_m", "retreat.push", push);
    list("retreat.direction", direction);
    list("retreat.velocity", velocity_at_fault);
    list("retreat.way_out", way_out);
    visit("retreat.stiffness", 0, stiffness);
    visit("retreat.untold_s", 0, untold_s);
    list("retreat.row", row);
    visit("retreat.time_s", 0, time_s);
    visit("retreat.free_s", 0, free_s);
    visit("retreat.way", 0, way);
    visit("retreat.way_to", 0, way_to);
    visit("retreat.speed", 0, speed);
    visit("retreat.marked_N", 0, marked_N);
    visit("retreat.way_at_mark", 0, way_at_mark);
  }

  void compensation(const CoverCompensationState& cover) const {
    const auto& [has_started, links, missed_s, p_center, v_center, origin, s0, s1, s2] = cover;
    list("cover.link_q", links.q);
    list("cover.link_velocity", links.velocity);
    visit("cover.missed_s", 0, missed_s);
    list("cover.p_center", p_center);
    list("cover.v_center", v_center);
    list("cover.origin", origin);
    list("cover.s0", s0);
    list("cover.s1", s1);
    list("cover.s2", s2);
  }

  void answer(const ContactControllerState& contact) const {
    const auto& [held_point, push, has_push, transition, joint_space, estimator, approach, law, cut,
                 cut_by_rows, keeps_joints, is_resting] = contact;
    point("held.force_N", "held.position_m", "held.direction", held_point);
    list("push", push);
    visit("cut", 0, cut);
    visit("cut_by_rows", 0, cut_by_rows);
    const auto& [touched, p_lost, gamma] = transition;
    list("transition.p_lost", p_lost);
    visit("transition.gamma", 0, gamma);

    const auto& [touching, joint_gamma, kappa, has_rested, joint_p_lost, joint_contact, response,
                 fade] = joint_space;
    visit("joint_space.gamma", 0, joint_gamma);
    visit("joint_space.kappa", 0, kappa);
    list("joint_space.p_lost", joint_p_lost);
    point("joint_space.force_N", "joint_space.position_m", "joint_space.direction", joint_contact);

    const auto& [stiffness, stiffness_raw, x_int_m, v_prev, F_prev, filter] = estimator;
    visit("estimator.stiffness", 0, stiffness);
    visit("estimator.stiffness_raw", 0, stiffness_raw);
    visit("estimator.x_int", 0, x_int_m);
    visit("estimator.v_prev", 0, v_prev);
    visit("estimator.F_prev", 0, F_prev);
    const auto& [V, It, null_speed] = law;
    visit("law.V", 0, V);
    visit("law.It", 0, It);
    limit(approach);
  }

  void limit(const ApproachLimitState& approach) const {
    const auto& [smoother, position, approach_estimator, obstacle, memory, way_ahead, is_limiting,
                 rested, memory_fade] = approach;
    visit("approach.rested", 0, rested);
    const auto& [significant, before, two_before, peak, weight, X_BaseModule, smooth, ringing,
                 smoothing] = smoother;
    visit("smoother.significant", 0, significant);
    list("smoother.force_before", before);
    list("smoother.force_two_before", two_before);
    visit("smoother.peak", 0, peak);
    visit("smoother.weight", 0, weight);
    list("smoother.R_BaseModule", X_BaseModule.R_AB.reshaped());
    list("smoother.p_BaseModule", X_BaseModule.p_AB);
    point("smoother.force_N", "smoother.position_m", "smoother.direction", smooth);
    const auto& [has_started, origin, commanded, lagged, s0, s1, s2, sensed, sensed_before,
                 drive_lag] = position;
    list("sensed.origin", origin);
    list("sensed.commanded", commanded);
    list("sensed.lagged", lagged);
    list("sensed.s0", s0);
    list("sensed.s1", s1);
    list("sensed.s2", s2);
    list("sensed.sensed", sensed);
    list("sensed.sensed_before", sensed_before);
    const auto& [c, r, x_m, F_ref, F_before, limited_s, falling, forgetting] = approach_estimator;
    visit("approach.c", 0, c);
    visit("approach.r", 0, r);
    visit("approach.x", 0, x_m);
    visit("approach.F_ref", 0, F_ref);
    visit("approach.F_before", 0, F_before);
    visit("approach.limited_s", 0, limited_s);
    const auto& [v_o, F_before_o, high_s, speed_filter] = obstacle;
    visit("obstacle.v", 0, v_o);
    visit("obstacle.F_before", 0, F_before_o);
    visit("obstacle.high_s", 0, high_s);
    visit("approach.memory", 0, memory);
    visit("approach.way_ahead", 0, way_ahead);
  }
};

/// Calls visit(name, index, value) for every number that a controller remembers from one cycle to
/// the next; index is that of a joint or an axis, 0 for a single number.
/// Of the tactile modules the first is visited, and the state of a law for several is not: none of
/// the extreme cases has several. Left out are sequences, which count, what is no number, and what
/// only spares computing it again.
template <typename Visit>
void visitNumbers(const ControllerState& state, const Visit& visit) {
  StateVisitor<Visit>{visit}.all(state);
}

}  // namespace tactus
