"""stub"""

from rotrecon.arrays import Cloud
from rotrecon.reconstruction import Reconstruction


def by_rays(segmented: Reconstruction, depth_m: Cloud) -> Reconstruction:
    """Soon."""
    return segmented
