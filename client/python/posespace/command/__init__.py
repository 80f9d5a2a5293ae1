# SPDX-License-Identifier: Apache-2.0
"""The command `posespace`: drawings in, meshes, pictures and animations out, no code needed."""
