# SPDX-License-Identifier: Apache-2.0
"""Tools that know nothing of posespace read its API from the service itself."""

import grpc
import pytest
from google.protobuf.descriptor_pool import DescriptorPool
from grpc_reflection.v1alpha.proto_reflection_descriptor_database import (
    ProtoReflectionDescriptorDatabase,
)


@pytest.fixture
def database(server):
    with grpc.insecure_channel(server.address) as channel:
        yield ProtoReflectionDescriptorDatabase(channel)


def test_every_service_is_listed(database):
    assert set(database.get_services()) == {
        "grpc.health.v1.Health",
        "grpc.reflection.v1alpha.ServerReflection",
        "posespace.v1.PoseService",
        "posespace.v1.SessionService",
    }


def test_every_listed_service_is_described(database):
    pool = DescriptorPool(database)
    for name in database.get_services():
        service = pool.FindServiceByName(name)
        assert service.methods, name
        for method in service.methods:
            assert method.input_type.full_name and method.output_type.full_name
