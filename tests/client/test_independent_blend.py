# SPDX-License-Identifier: Apache-2.0
"""What the service computes, against the formulas computed here with NumPy alone."""

from __future__ import annotations

import numpy as np
import posespace
import pytest
from dense_rigid_blend import DenseRigidBlend
from numpy.typing import NDArray
from synthetic_drawings import wavy_blob

AGREEMENT = 2e-5  # of a drawing's size; the service answers in float32


def size_of(mesh: posespace.Mesh) -> float:
    """Square root of the smallest drawing's area."""
    areas = []
    for points in mesh.vertices.values():
        a, b, c = (points[mesh.triangles[:, k]] for k in range(3))
        u, v = b - a, c - a
        areas.append(float((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2))
    return min(areas) ** 0.5


def dense(mesh: posespace.Mesh, base: str = "mean") -> DenseRigidBlend:
    poses = np.stack([mesh.vertices[name] for name in mesh.shape_ids])
    turns = np.array([mesh.turns[name] for name in mesh.shape_ids], dtype=float)
    return DenseRigidBlend(poses, mesh.triangles, turns, base)


def arc(bend: float) -> NDArray[np.float64]:
    """A strip of length 300, bent by `bend` radians in all, as a ring."""
    rows = np.linspace(0, 1, 40)
    angle = bend * (rows - 0.5)
    along = np.cumsum(np.stack([np.cos(angle), np.sin(angle)], 1), axis=0) * (300 / len(rows))
    across = 12 * np.stack([-np.sin(angle), np.cos(angle)], 1)
    return 400 + np.concatenate([along - across, (along + across)[::-1]])


WEIGHTS = [
    {"stand": 1 / 3, "step": 1 / 3, "wave": 1 / 3},
    {"stand": 0.5, "wave": 0.5},
    {"stand": 0.05, "step": 0.9, "wave": 0.05},
    {"stand": -0.3, "step": 0.2, "wave": 1.1},
    {"stand": 1.6, "step": -0.4, "wave": -0.2},
]


@pytest.fixture(scope="module")
def walk_mesh(walk):
    return walk.mesh()


@pytest.fixture(scope="module")
def model(walk_mesh):
    return dense(walk_mesh)


@pytest.mark.parametrize("refits", [0, 1, 2, 3])
@pytest.mark.parametrize("weights", WEIGHTS)
def test_blend_is_the_least_squares_solution(walk, walk_mesh, model, weights, refits):
    mesh = walk_mesh
    w = np.array([weights.get(name, 0.0) for name in mesh.shape_ids])
    frame = walk.blend(weights=weights, refits=refits)
    error = np.abs(frame.vertices - model.at(w, refits)).max()
    assert error <= AGREEMENT * size_of(mesh)


def test_blend_at_points_is_the_least_squares_solution(walk, walk_mesh, model):
    points = np.random.default_rng(7).uniform(-0.5, 1.5, (20, 2))
    weights = walk.weights(points)
    for vertices, w in zip(walk.blend_many(points), weights, strict=True):
        assert np.abs(vertices - model.at(w)).max() <= AGREEMENT * size_of(walk_mesh)


@pytest.mark.parametrize("limit", ["band", "hermite", "off"])
def test_shear_limits_are_their_formulas(walk, walk_mesh, model, limit):
    mesh = walk_mesh
    w = np.array([-0.15, 0.08, 1.07])
    weights = dict(zip(mesh.shape_ids, w, strict=True))
    frame = walk.blend(weights=weights, shear_limit=limit)
    error = np.abs(frame.vertices - model.at(w, limit=limit)).max()
    assert error <= AGREEMENT * size_of(mesh)


def test_paper_method_has_the_first_drawing_as_rest_shape(walk, walk_mesh):
    mesh = walk_mesh
    w = np.array([0.2, 0.5, 0.3])
    frame = walk.blend(weights=dict(zip(mesh.shape_ids, w, strict=True)), method="paper")
    expected = dense(mesh, base="first").at(w, refits=0, limit="hermite")
    assert np.abs(frame.vertices - expected).max() <= AGREEMENT * size_of(mesh)


def test_linear_method_is_the_mean_of_the_vertices(walk, walk_mesh):
    mesh = walk_mesh
    w = np.array([0.2, 1.1, -0.3])
    frame = walk.blend(weights=dict(zip(mesh.shape_ids, w, strict=True)), method="linear")
    expected = sum(w[i] * mesh.vertices[name] for i, name in enumerate(mesh.shape_ids))
    assert np.abs(frame.vertices - expected).max() <= AGREEMENT * size_of(mesh)


def test_parts_that_turn_by_more_than_half_a_turn_keep_turning(session):
    session.put_shape("straight", polygon=arc(0.0))
    session.put_shape("curl", polygon=arc(4.2))
    session.set_correspondences(
        [{"straight": arc(0.0)[row], "curl": arc(4.2)[row]} for row in (0, 79)]
    )
    session.build()
    mesh = session.mesh()
    bent = dense(mesh)
    for t in (0.25, 0.5, 0.75):
        frame = session.blend(weights={"straight": 1 - t, "curl": t})
        expected = bent.at(np.array([1 - t, t]))
        assert np.abs(frame.vertices - expected).max() <= AGREEMENT * size_of(mesh)
        assert frame.folds == 0


def test_texture_weights_sharpen_with_sigma(walk):
    ids = walk.shape_ids
    w = np.array([0.5, 0.3, 0.2])
    soft, sharp, step = (
        list(walk.blend(weights=dict(zip(ids, w, strict=True)), sigma=s).texture_weights.values())
        for s in (0.0, 0.6, 1.0)
    )
    assert np.allclose(soft, w)
    t = np.clip((w / (w[0] + w[1]) - 0.3) / 0.4, 0, 1)
    expected = 0.6 * t * t * (3 - 2 * t) + 0.4 * w
    assert np.allclose(sharp, expected / expected.sum())
    assert np.allclose(step, [1, 0, 0])


# Weights over pose space.


@pytest.fixture(scope="module")
def layout(client):
    """Five placements in general position; what they place matters little here."""
    places = np.array([[0, 0], [3, 0.5], [2.4, 2.2], [0.3, 1.7], [1.4, 1.1]])
    session = client.create_session()
    for k in range(len(places)):
        session.put_shape(f"blob{k}", polygon=wavy_blob(3, 0.05 + 0.04 * k, rows=60))
    session.set_placements({f"blob{k}": at for k, at in enumerate(places)})
    session.build()
    yield session, places
    session.delete()


def test_weights_sum_to_one_near_and_far(layout):
    session, _ = layout
    rng = np.random.default_rng(3)
    points = np.concatenate(
        [rng.uniform(-3, 6, (600, 2)), rng.normal(0, 1e3, (50, 2)), rng.normal(0, 1e9, (50, 2))]
    )
    assert np.abs(session.weights(points).sum(axis=1) - 1).max() <= 1e-6


def test_weights_are_exact_at_the_placements(layout):
    session, places = layout
    assert np.abs(session.weights(places) - np.eye(len(places))).max() <= 1e-6


def test_halfway_between_two_poses_both_weigh(layout):
    session, places = layout
    halfway = session.weights([(places[0] + places[4]) / 2])[0]
    assert (halfway[[0, 4]] > 0.3).all()
    assert (np.abs(halfway[[1, 2, 3]]) < 0.3).all()


def velocity_jump(session, start, direction, t, h):
    """|f(t+h) - 2 f(t) + f(t-h)| / h: tends to 0 with h where velocity is continuous, and to the
    size of its jump where it is not."""
    steps = np.concatenate([t - h, t, t + h])
    weights = session.weights(start + steps[:, None] * direction).reshape(3, len(t), -1)
    return np.abs(weights[2] - 2 * weights[1] + weights[0]).max(axis=1) / h


def lines_through_pose_space(places):
    low, high = places.min(axis=0), places.max(axis=0)
    diameter = max(np.linalg.norm(p - q) for p in places for q in places)
    centre = (low + high) / 2
    corner = high + 0.5 * diameter  # of the domain; its sides and corners are crossed as well
    along = np.array([1.0, 0.0])
    yield "through two poses", places[0], places[2] - places[0]
    yield "across the rim", centre, np.array([1.0, 0.37])
    yield "across the upper rim", centre, np.array([0.11, 1.0])
    yield "through a corner", corner, corner - centre
    yield "past a corner", corner - [0.05 * diameter, 0], np.array([1.0, -0.6])
    yield "along the rim", corner - [0, 1e-3 * diameter], along
    yield "in general", centre - [0.3, 0.2], np.array([-0.6, 1.0])


def test_weights_have_no_velocity_jump(layout):
    session, places = layout
    diameter = max(np.linalg.norm(p - q) for p in places for q in places)
    for name, start, direction in lines_through_pose_space(places):
        direction = direction / np.linalg.norm(direction)
        t = np.linspace(-1.6, 1.6, 6401) * diameter
        step = t[1] - t[0]
        coarse = velocity_jump(session, start, direction, t, step)
        for worst in t[np.argsort(coarse)[-8:]]:  # closer and closer to each of the worst places
            h = step
            for _ in range(4):
                around = worst + np.linspace(-1, 1, 81) * h
                h /= 20
                jump = velocity_jump(session, start, direction, around, h)
                worst = around[jump.argmax()]
            assert jump.max() <= 1e-4 / diameter, (
                f"{name}: velocity jumps by {jump.max():.2g} near {start + worst * direction}"
            )


def test_the_measure_of_velocity_jumps_sees_one():
    class Kinked:
        def weights(self, points):
            return np.maximum(points[:, :1] - 0.123456, 0) * 0.01

    t = np.linspace(-1, 1, 201)
    jump = velocity_jump(Kinked(), np.zeros(2), np.array([1.0, 0.0]), t, t[1] - t[0])
    assert jump.max() > 0.003
