"""The registry holds every variable of the format that we know of, each with a row that makes sense."""

import pytest

from flowgmo.deck.defaults import NAMED, default_of, default_text
from flowgmo.deck.explain import explain
from flowgmo.deck.row import INDEX
from flowgmo.deck.variables import ALIASES, BLOCKS, REGISTRY

# All names of the tables in the order of the format's description; families are written out by `names_of`.
NAMES = {
    "XPUT": """
        TWFIN ITWFIN IFIN FRCFIN ICHKSTDY DLTSTDY TSTDY DELT DTMIN TDTMAX TEDITDT AUTOT CON CONFS CONSFT CONHT CONES
        CONSHR DELTR IFREST TREST ITRST RESFILE IEDT TPLTD TAPLTD THPLTD TPRTD TSPRTD TEDIT ESPRTDT PLTFRC PLTAFRC
        PRTFRC LPR IBENCH ITIMER IHELP IDBG IFIED IFCOMP_VF ITB NMAT ICMPRS IFVISC IFVIS IWSH G/XYZ IACCF IPDIS IFSFT
        IMPSFT IFENRG IHTC IMPHTC IFRHO IPHCHG ICAV IMOBS ICLID STRNGMOB FRCMOB IMPMOB IDPTH OFFSET RHOAIR IMEMB ISWAT
        ISCOUR IFVELP IUSRD DUM1 IDUM1 INTDUM FPDUM IORDER ALPHA IMPADV IMPADV2 DT_THRESH V_THRESH DTIMPX IFVOF IFPK
        CFPK FCLEAN FCLEAN2 IF_VOL_CORR IVOL_CORR_TIME VOL_CORR_TIME IMP IGMRES IADI/XYZ OMEGA IFDYNCONV EPSADJ EPSI
        IOPT_GMRES ETA_REL ETA_ABS IAUTOSET ITRNMAX IMPVIS EPSVIS OMEGVS IFFS IBM IBM_PROBE_DIRECTION_METHOD IFLOSS
        ALPHAMB SSACC SSCOF CNU CDIS1 CDIS2 CDIS3 CSPRO CRHO RMTKE RMDTKE TLEN ITLEN PLTDT HPLTDT PRTDT SPRTDT""",
    "LIMITS": """
        EPS VFCLEAN ITMAX ITMIN ITDTMX ITFLMX NCFLMX MRSTRT ITVSMX ILPR IRPR JFPR JBKPR KBPR KTPR XLPR XRPR YFPR YBKPR
        ZBPR ZTPR""",
    "PROPS": """
        RHOF RHOF2 MU1 MU2 MUI RCSQL RCSQV SIGMA CSIGMA CANGLE FRCOF FLUID1 FLUID2 UNITS TUNITS MUNITS LUNITS TIMUNITS
        CUNITS IPGAUGE P_REFERENCE T_REFERENCE CV1 CV2 THC1 THC2 THEXF1 THEXF2 TSTAR GAMMA PCAV IMU1 MUC0 MUC1 MUC2
        MUC3 MUC4 MUCTST MULES""",
    "SCALAR": "NSC SCLTIT ISCLR",
    "RBDATA": """
        RBMASS RBJXX RBJYY RBJZZ RBJXY RBJXZ RBJYZ RCXP RCYP RCZP UCXP UCYP UCZP OMXI OMYI OMZI IRBACC NCRBMX OMDIMP
        EPSIRB""",
    "PARTS": "NPXYZ NP/XYZ XPL XPR YPF YPBK ZPB ZPT UPI VPI WPI",
    "HEADER": "PROJECT VERSION NPROCS RUN_WITH_AVAILABLE",
    "RENDERSPACE": "RSXMIN RSXMAX RSYMIN RSYMAX RSZMIN RSZMAX RSCSIZE IFRS QVAL_FAVOR",
    "GRAFIC": "ANMTYP XLOC YLOC ZLOC WINTL IF_PROBE_ENABLED NPMOV LOCOBS LOCOPT",
    "BCDATA": """
        IBCT TIMBCT UBCT VBCT WBCT PBCT FBCT IHPBCT FLHTBCT IPBCTP IPOUTBCT RHOBCT FLRBCT FN/XYZ IOBCTP INWAVE IWAVEBC
        WAVEAMP WAVEPER WAVELEN WAVEPHS WAVEH IHTBCT TBCT HWALL1 FFLHTBCT IFLHTBCTC FUBCT IUBCTC FVBCT IVBCTC FWBCT
        IWBCTC FPBCT IPBCTC FFBCT IFBCTC FRHOBCT IRHOBCTC FFLRBCT IFLRBCTC FTBCT ITBCTC WL WR WF WBK WB WT""",
    "MESH": """
        MESHNAME ICYL P/XYZ PYA NXCELT NYCELT NZCELT NXCELL NYCELL NZCELL SIZE/XYZ IF_SIZE SIZE NTOTAL MESH_RANK
        MESH_TYPE MESH_COMP OVERLAP ICMBOBS IF_MESH_ENABLED ISWATLOC""",
    "FL": """
        IFLINITTYP FLHT VLIN PVOID PRESI UI VI WI TKEI RPSI TEMPI TVOID NFLS FXL FXH FYL FYH FZL FZH FRAL FRAH FRSL
        FRSH FANGLL FANGLH FCONEL FCONEH FIOH IFDIS FFSTL FCC FC/XYZ FCXY FCXZ FCYZ FCX2 FCY2 FCZ2 FCRXY FREG PREG UREG
        VREG WREG RHOREG TREG FROT/XYZ FTRN/XYZ FMAGN FMAGN/XYZ FXTRFC FYTRFC FZTRFC FLUIDREGIONNAME IF_FLREG_ENABLED
        XVR YVR ZVR PVRD TIMVRD IFVRD FVRD FPVRD IPVRDC UDEEP VDEEP WDEEP IFLU""",
    "BF": """
        NBAFS IBAF B/XYZ ISTLBF BXL BXH BYL BYH BZL BZH BRAL BRAH BIOH PBAF KBAF1 KBAF2 IFBAF FPTITL IFRCBF BROT/XYZ
        BTRN/XYZ BMAGN BMAGN/XYZ""",
    "MOTN": """
        IATYPE RC/XYZ GRAV/XYZ A0 OMG0 RPS SPIN TMAG/XYZ TFREQ/XYZ TPHI/XYZ RMAG/XYZ RFREQ/XYZ RPHI/XYZ FMOVIN ACONV
        OMCONV""",
    "OBS": """
        NOBS OBSID SUBCMPID MATERIAL IFCOMPENABLED IFSUBCOMPENABLED IOB IOH IGEN FSTL XL XH YL YH ZL ZH RAL RAH RSL RSH
        ANGLL ANGLH CONEL CONEH RTORIN RTOROUT CC C/XYZ CXY CXZ CYZ CX2 CY2 CZ2 CRXY MAGN MAGN/XYZ ROT/XYZ TRN/XYZ
        XTRFC YTRFC ZTRFC GMAGN GMAGN/XYZ GROT/XYZ GTRN/XYZ GXTRFC GYTRFC GZTRFC IGTRFMVB ICPY IVRT CMAGN CMAGN/XYZ
        CROT/XYZ CTRN/XYZ CRFL/XYZ IFOB ROUGH ROUGHSUB OFRCOF OCANG IFRCO XFRCO YFRCO ZFRCO IFWETAR IBUOYO IPREF
        PREFMBW IAVRCK AVRCK IFSPIN OSPIN FOSPIN IOSPINC CMO/XYZ CMOX2 CMOY2 CMOZ2
        IMO IMOAXS XAXS0 YAXS0 ZAXS0 XREF0 YREF0 ZREF0 IUMCAL IVMCAL IWMCAL IOMXCAL IOMYCAL IOMZCAL IUPRE IVPRE IWPRE
        IOMXPRE IOMYPRE IOMZPRE TOBS UTOBS VTOBS WTOBS OMXTOBS OMYTOBS OMZTOBS UAMP UFRE UPHS VAMP VFRE VPHS WAMP WFRE
        WPHS OMXAMP OMXFRE OMXPHS OMYAMP OMYFRE OMYPHS OMZAMP OMZFRE OMZPHS FUTOBS IUTOBSC FVTOBS IVTOBSC FWTOBS
        IWTOBSC FOMXTOBS IOMXTOBSC FOMYTOBS IOMYTOBSC FOMZTOBS IOMZTOBSC DXMCMIN DXMCMAX DYMCMIN DYMCMAX DZMCMIN
        DZMCMAX ANGLMIN ANGLMAX NEVENTS_GMO EVENT_ACTION_GMO UTOBS_EVENT VTOBS_EVENT WTOBS_EVENT OMXTOBS_EVENT
        OMYTOBS_EVENT OMZTOBS_EVENT IPRPMVB RHOMVB RHOSUB MASSMVB XMCMVB0 YMCMVB0 ZMCMVB0 TJMVB TJAXS IGF IREFGF FXTOBS
        FYTOBS FZTOBS TXTOBS TYTOBS TZTOBS FXTOBSM FYTOBSM FZTOBSM FFXTOBS IFXTOBSC FTXTOBS ITXTOBSC FFXTOBSM IFXTOBSMC
        FFYTOBSM FFZTOBSM XFPNT YFPNT ZFPNT IREFGFM NSPRP IFSP IOBSP1 IOBSP2 XSP01 YSP01 ZSP01 XSP02 YSP02 ZSP02 ASP
        BSP CSP DMPSP TSP0 CSPUNIT DIASP RHOSP RHOSP_MAT CDSPN CDSPT NSEGSP FSPBRK XSPMN XSPMX YSPMN YSPMX ZSPMN ZSPMX
        IF_SPRP_ENABLED SPRINGNAME CRSTRNG CFRC ICLIDOB""",
    "FLOWGMO": """
        IMPACT DPFRAC SEARCH MULTIPLE HERTZ TOUCH RESTING SLEEP WETIMPACT LUBRICATION FILMROUGH AXIS/XYZ PLANE/XYZ
        RESTART_DT IGNORE_UNSUPPORTED""",
}


def names_of(text: str) -> list[str]:
    """`G/XYZ` stands for GX, GY, GZ."""
    parts = [word.partition("/") for word in text.split()]
    return [stem + ending for stem, _, endings in parts for ending in endings or ("",)]


@pytest.mark.parametrize("block", NAMES)
def test_every_name_is_there(block: str) -> None:
    """Each name has a row, in its block."""
    for name in names_of(NAMES[block]):
        assert name in REGISTRY, name
        assert REGISTRY[name].block == block, name


def test_rows_make_sense(read) -> None:
    """Types, indices, classes; defaults that are in range and have words; a meaning of our own for each."""
    deck = read()
    for row in REGISTRY.values():
        assert row.block in BLOCKS and row.type in ("int", "real", "char", "logical"), row.name
        assert row.cls in ("computed", "accepted", "known", "alias") and row.needs in ("", "liquid"), row.name
        assert all(letter in INDEX for letter in row.shape), row.name
        assert bool(row.time) <= (row.shape[:1] == ("t",)), row.name
        assert not row.time or REGISTRY[row.time].shape == ("t",), row.name
        assert not row.switch or row.switch in REGISTRY, row.name
        assert row.meaning and default_text(row), row.name
        assert (row.cls == "alias") == (row.name in ALIASES), row.name
        assert set(row.not_yet) < set(row.allowed or (1,)), row.name
        value = default_of(deck, row, (1,) * len(row.shape))
        assert value is None or row.admits(value), row.name
        kinds = {"int": int, "real": float, "char": str, "logical": bool}
        assert value is None or type(value) is kinds[row.type], row.name


def test_our_defaults() -> None:
    """Where the vendor's default would cost accuracy or stability, ours differs."""
    ours = {"IMPMOB": "1", "IFVOF": "6", "IORDER": "3", "IFPK": "0", "EPS": "1e-4", "IVMCAL": "1"}
    assert {name: REGISTRY[name].default for name in ours} == ours


def test_default_functions_are_used() -> None:
    assert {row.default[1:] for row in REGISTRY.values() if row.default.startswith("@")} == set(NAMED)


def test_defaults_that_depend_on_others(read) -> None:
    """Conditional defaults, each at one deck that turns it."""
    eng = read(props="units='eng', tunits='f', ipgauge=0", add_xput="igmres=0, impsft=1,")
    assert (eng["T_REFERENCE"], eng["RHOAIR"]) == (32.0, 2.3769e-3)
    assert eng["P_REFERENCE"] == eng["PVOID"] == eng.at("PBCT", 1, 2) == 2116.22
    assert (eng["OMEGA"], eng["ITMAX"], eng["CONSFT"], eng["ITDTMX"]) == (1.7, 1000, 2.5, 12)
    deck = read(add_xput="igmres=2, impvis=3, impmob=0", mesh="px=0.,2.,3., nxcell=4,5, size=.25, sizez(1)=.1")
    assert (deck["OMEGA"], deck["ITMAX"], deck["ITVSMX"]) == (2.0, 200, 100)
    assert (deck["NXCELT"], deck["NYCELT"], deck["NZCELT"]) == (9, 4, 10)
    assert read(mesh="px=0.,2., if_size=0, ntotal=2000")["NXCELT"] == 20
    assert read(mesh="px=0.,1.,2.,3.,")["NXCELT"] == 3 and read(mesh="size=1e-300")["NXCELT"] == 2**31 - 1
    assert read(add_xput="impmob=0")["ITDTMX"] == 10


def test_explain() -> None:
    """Readable text with what a user looks for; nearest names for a misspelt one."""
    text = explain("imo(2)")
    assert "imo(m)" in text and "&obs" in text and "0, 2, 3, 4" in text and "known, not computed: 2" in text
    assert "FLUID" not in explain("wl") and "ibct(1)" in explain("wl")
    assert "tobs" in explain("utobs") and "acts only together with ifsft" in explain("sigma")
    assert "TWFIN/1000" in explain("DELT") and "0 is off" in explain("ifsft")
    with pytest.raises(KeyError) as caught:
        explain("strngmb")
    assert caught.value.args[0] == "strngmob"
