# SPDX-License-Identifier: Apache-2.0
import sys

from posespace.command.main import main

sys.exit(main())
