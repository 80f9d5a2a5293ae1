# SPDX-License-Identifier: Apache-2.0
"""The service's messages, made from proto/posespace/v1 when the package is built."""
