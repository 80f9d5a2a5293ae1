// SPDX-License-Identifier: Apache-2.0
#include "rpc/server.h"

#include <grpc/health/v1/health.pb.h>
#include <grpcpp/ext/health_check_service_server_builder_option.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "rpc/transport_options.h"

namespace posespace {
namespace {

constexpr std::size_t kWaitingBlends = 4'096;  // a few seconds of work
constexpr std::size_t kWaitingUploads = 64;    // each may hold a whole request
constexpr int kBulkNiceness = 5;               // pictures, uploads and loads give way to frames
constexpr int kMatchingNiceness = 19;          // as long as builds, and as patient

int Cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

// Lists and describes every service, gRPC's health check too: reflection fails as a whole for a
// service whose descriptor is not linked, and gRPC itself links none of its own.
void EnableReflection() {
  grpc::health::v1::HealthCheckRequest::descriptor();
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
}

}  // namespace

Server::Server(std::unique_ptr<Registry> registry)
    : registry_(std::move(registry)),
      streams_(registry_->limits().max_streams),
      blend_pool_(Cores(), kWaitingBlends, 0),
      bulk_pool_(Cores(), kWaitingUploads, kBulkNiceness),
      matching_pool_(std::max(1, registry_->limits().concurrent_builds),
                     static_cast<std::size_t>(registry_->limits().build_queue), kMatchingNiceness),
      session_service_(*registry_, streams_, bulk_pool_, matching_pool_),
      pose_service_(*registry_, streams_, blend_pool_, bulk_pool_) {}

Server::~Server() { Shutdown(std::chrono::milliseconds(0)); }

Result<std::unique_ptr<Server>> Server::Start(const std::string& listen, const Limits& limits,
                                              std::shared_ptr<Store> store) {
  auto registry = store == nullptr ? std::make_unique<Registry>(limits)
                                   : TRY(Registry::Open(limits, std::move(store)));
  std::unique_ptr<Server> service(new Server(std::move(registry)));
  grpc::EnableDefaultHealthCheckService(true);
  EnableReflection();
  grpc::ServerBuilder builder;
  SetTransportOptions(builder, limits);
  builder.AddListeningPort(listen, grpc::InsecureServerCredentials(), &service->port_);
  builder.RegisterService(&service->session_service_);
  builder.RegisterService(&service->pose_service_);
  service->server_ = builder.BuildAndStart();
  if (!service->server_) {
    return Error{ErrorCode::kInvalidOption,
                 "cannot listen on " + listen + ": it is in use, or not an address of this machine",
                 {}};
  }

  const bool unix_socket = listen.starts_with("unix:");
  if (unix_socket) service->port_ = 0;
  service->address_ =
      unix_socket ? listen
                  : listen.substr(0, listen.rfind(':') + 1) + std::to_string(service->port_);
  grpc::HealthCheckServiceInterface& health = *service->server_->GetHealthCheckService();
  health.SetServingStatus(true);
  health.SetServingStatus(v1::SessionService::service_full_name(), true);
  health.SetServingStatus(v1::PoseService::service_full_name(), true);
  service->pulse_ = std::make_unique<Pulse>(
      *service->server_, [&streams = service->streams_](auto now) { streams.Beat(now); });
  return service;
}

void Server::BeginDrain(std::chrono::milliseconds grace) {
  server_->GetHealthCheckService()->Shutdown();
  streams_.Drain(grace);
  registry_->build_pool().CancelAll();
}

void Server::Shutdown(std::chrono::milliseconds patience) {
  if (!server_) return;
  pulse_.reset();
  server_->Shutdown(std::chrono::system_clock::now() + patience);
  server_.reset();
}

}  // namespace posespace
