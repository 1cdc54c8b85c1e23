# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""What fails."""


class Error(Exception):
    """Something could not be done. Its text says what was wrong and what is right.

    code: "invalid_argument", "not_found", "corrupt", "unavailable" (trying again may help), "busy",
        "timeout", "unsupported" or "internal".
    """

    code: str

    def __init__(self, message: str, code: str = "invalid_argument") -> None:
        super().__init__(message)
        self.code = code
