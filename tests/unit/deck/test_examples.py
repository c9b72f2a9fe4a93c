"""Two complete wet decks in the two styles of the format: nothing is wrong with them."""

import pytest

BOX = """ Coupled six-DOF light box released above a free surface
 second title line, ignored by the reader

 &xput
    remark='SI units',
    twfin=2.0, delt=1.e-4, dtmin=1.e-9, autot=1.0, con=0.45,
    itb=1, nmat=1, ifvof=4, ifpk=0,
    ifvisc=1, ifvis=0, iorder=1, impvis=0,
    imp=1, igmres=1, ifdynconv=1, epsadj=1.0,
    ipdis=1, gz=-9.81, imobs=1, impmob=1,
    iclid=1, strngmob=0.5, frcmob=0.3,
    tpltd(1)=0.2, thpltd(1)=0.01, tsprtd(1)=0.05, tprtd(1)=1.0,
 /

 &limits
    eps=1.e-4, itmax=100, itflmx=25,
 /
 &props
    units='si', tunits='k', ipgauge=1,
    fluid1='water',
    rhof=1000.0, mu1=1.e-3, rcsql=1.e-9,
 /
 &scalar
 /
 &bcdata
    remark='sides symmetry, floor wall, lid at constant pressure',
    ibct(1)=1, ibct(2)=1, ibct(3)=1, ibct(4)=1,
    ibct(5)=2,
    ibct(6)=5, pbct(1,6)=0.0, fbct(1,6)=0.0,
 /
 &mesh
    meshname='tank',
    px(1)=0.0, px(2)=1.0, nxcelt=50,
    py(1)=0.0, py(2)=1.0, nycelt=50,
    pz(1)=0.0, pz(2)=1.2, nzcelt=60,
 /
 &obs
    nobs=2, avrck=3.1,

    obsid(1)='box', imo(1)=4, imoaxs(1)=0,
    iprpmvb(1)=0, rhomvb(1)=600.0,
    iumcal(1)=1, ivmcal(1)=1, iwmcal(1)=1,
    iomxcal(1)=1, iomycal(1)=1, iomzcal(1)=1,
    utobs(1,1)=0.2, vtobs(1,1)=0.0, wtobs(1,1)=-1.0,
    omxtobs(1,1)=0.0, omytobs(1,1)=2.0, omztobs(1,1)=0.0,
    crstrng(1)=0.6, cfrc(1)=0.2, iclidob(1,2)=1,
    iob(1)=1, ioh(1)=1, igen(1)=0,
    xl(1)=0.40, xh(1)=0.60, yl(1)=0.40, yh(1)=0.60, zl(1)=0.70, zh(1)=0.90,

    obsid(2)='pillar', imo(2)=0,
    iob(2)=2, ioh(2)=1, igen(2)=0, rah(2)=0.05, zl(2)=0.0, zh(2)=0.6,
    trnx(2)=0.8, trny(2)=0.5,
 /
 &fl
    iflinittyp=1, flht=0.5, pvoid=0.0,
 /
 &bf
 /
 &motn
 /
 &grafic
    anmtyp(1)='f', anmtyp(2)='p', anmtyp(3)='vel',
    xloc(1)=0.2, yloc(1)=0.5, zloc(1)=0.25,
 /
 &renderspace
 /
 &header
    project='drop_box', version='double', nprocs=0,
 /
 &parts
 /
 free text after the last block is ignored
"""

FLAP = """ Bottom-hinged flap (coupled, fixed y axis) and prescribed piston

 $xput
  twfin=10., itb=1, ifvisc=1, gz=-9.81, ipdis=1,
  imobs=1, impmob=1, iclid=0,
 $end
 $limits
 $end
 $props
  units='si', tunits='c', ipgauge=1, rhof=998.2, mu1=1.e-3,
 $end
 $bcdata
  ibct(1)=2, ibct(2)=8, ibct(3)=1, ibct(4)=1, ibct(5)=2, ibct(6)=5,
  fbct(1,6)=0.0, pbct(1,6)=0.0,
 $end
 $mesh
  px(1)=0., px(2)=3., px(3)=5., nxcell(1)=120, nxcell(2)=80,
  py(1)=0., py(2)=0.5, nycelt=20,
  pz(1)=0., pz(2)=1.0, nzcelt=50,
 $end
 $obs
  nobs=2,
  obsid(1)='piston', imo(1)=3, imoaxs(1)=0, iupre(1)=1,
  uamp(1)=0.30, ufre(1)=0.5, uphs(1)=90.,
  dxmcmin(1)=0.3, dxmcmax(1)=0.3,
  iob(1)=1, xl(1)=0.1, xh(1)=0.2,
  obsid(2)='flap', imo(2)=4, imoaxs(2)=2,
  xaxs0(2)=3.0, zaxs0(2)=0.05,
  iprpmvb(2)=1, massmvb(2)=12.0, tjaxs(2)=0.9,
  xmcmvb0(2)=3.0, ymcmvb0(2)=0.25, zmcmvb0(2)=0.30,
  anglmin(2)=45., anglmax(2)=45., omytobs(1,2)=0.0,
  iob(2)=2, xl(2)=2.95, xh(2)=3.05, zl(2)=0.05, zh(2)=0.55,
 $end
 $fl
  iflinittyp=1, flht=0.4,
 $end
 $bf
 $end
 $motn
 $end
 $grafic
 $end
 $parts
 $end
"""


@pytest.mark.parametrize(("deck", "density", "height"), [(BOX, "1000.0", "0.5"), (FLAP, "998.2", "0.4")])
def test_example(read, deck: str, density: str, height: str) -> None:
    """Wet or dry: no problem, and the same bodies."""
    wet = read(deck)
    assert wet.notices == [] and wet["RHOF"] == float(density)
    dry = read(deck.replace(f"rhof={density},", "").replace(f"flht={height},", ""))
    assert dry.notices == []
    for name in ("IMO", "XL", "OBSID", "RHOMVB", "IBCT"):
        assert dry.indices(name) == wet.indices(name)


def test_values(read) -> None:
    """Some of what the decks say."""
    box = read(BOX.replace("rhof=1000.0,", "").replace("flht=0.5,", ""))
    assert box.title.startswith("Coupled six-DOF") and box.at("OBSID", 2) == "pillar"
    assert (box.at("CRSTRNG", 1), box.at("CRSTRNG", 2), box.at("ICLIDOB", 1, 2)) == (0.6, 0.5, 1)
    assert box.series("WTOBS", 1).y.tolist() == [-1.0]
    flap = read(FLAP.replace("rhof=998.2,", "").replace("flht=0.4,", ""))
    assert (flap["NXCELT"], flap.at("AXISY", 2), flap.at("UAMP", 1), flap["DELT"]) == (200, 1.0, 0.3, 0.01)
