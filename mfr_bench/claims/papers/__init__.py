"""The claims, a file for each line of papers, in the order in which they are listed."""

from . import gpupro5, kplus, occupancy, sbuffer, twochannel

CLAIMS = (*sbuffer.CLAIMS, *kplus.CLAIMS, *gpupro5.CLAIMS, *occupancy.CLAIMS, *twochannel.CLAIMS)
