"""The one contract, over every arm of ours."""

import pytest

from latentarm.arms.catalogue import ARMS
from latentarm.testing.arms import ArmContract


class TestEveryArm(ArmContract):
    @pytest.fixture(params=list(ARMS))
    def make(self, request):
        return ARMS[request.param]
